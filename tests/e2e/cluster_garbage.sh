#!/bin/sh
# cluster_garbage.sh - whatever arrives on their sockets, the daemons go on
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

cluster_start 2 1

# what is no message ends the connection, and nothing else
head -c 100000 /dev/urandom >noise
printf 'GET / HTTP/1.0\r\n\r\n' >http
: >nothing
# the right magic, a length that nobody has
printf 'RADD\000\001\000\000\000\000\000\000\377\377\377\377' >huge
printf 'RADD\000\001\377\377\000\000\000\000\000\000\000\004abcd' >flags
printf 'RADD\000\054\000\000\000\000\000\000\000\000\000\004abcd' >result
for where in "unix $sock" "tcp $tcp" "$(cat w1.ports)" "$(cat w2.ports)"; do
    for what in noise http huge flags result; do
        "$poke" "$where" <$what >answer ||
            fail "$what on '$where' left it open"
    done
done

# HELLO of versions 9 to 9: refused, with a reason
printf 'RADD\000\001\000\000\000\000\000\001\000\000\000\005' >hello9
printf '\000\011\000\011\001' >>hello9
"$poke" "unix $sock" <hello9 >answer || fail "another version was let in"
grep -q version answer || fail "the refusal does not say why"

grep -q 'protocol error peer=' c.log || fail "radcoord's log names nobody"
grep -q 'connection refused peer=127.*no TLS' w1.log ||
    fail "radd's log names nobody"
gone "$coord_pid" && fail "radcoord is gone"
gone "$pid_1" && fail "worker 1 is gone"
until_true 10 n_workers 2 || fail "the workers are not there any more"
"$radsubmit" --coordinator="$sock" -vf "$scenes/room.vf" -x 60 -y 40 -ab 0 \
    -o after.hdr "$scenes/room.rad" 2>stderr || fail "after: $(cat stderr)"
cluster_finish
