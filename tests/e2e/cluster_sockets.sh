#!/bin/sh
# cluster_sockets.sh - where daemons listen, what they refuse, how they stop
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

for at in 0.0.0.0:0 192.0.2.1:0 '[::]:0'; do
    expect 77 "loopback" "radcoord at $at" \
        "$radcoord" --listen="$at" --socket= --state="$work/s"
    expect 77 "loopback" "radd at $at" "$radd" --listen="$at" --cache="$work/s"
done
expect 64 "unknown" "unknown option" "$radd" --nonsense
expect 64 "threads" "bad number" "$radd" --threads=many
expect 64 "log_level" "bad log level" "$radcoord" --log-level=shout
expect 66 "nowhere.conf" "missing settings" "$radd" --config=nowhere.conf
printf 'threads = 2\nthreds = 3\n' >bad.conf
expect 78 "bad.conf:2" "bad settings" "$radd" --config=bad.conf
expect 73 "" "no place for its state" \
    "$radcoord" --state=/dev/null/x --listen=127.0.0.1:0 --socket=
for program in "$radcoord" "$radd"; do
    "$program" --help | grep -q -e --config || fail "$program --help"
    "$program" --version | grep -q radd || fail "$program --version"
done

# whoever may not make the default socket gets along with an address
if [ ! -w /run ]; then
    "$radcoord" --listen=127.0.0.1:0 --state="$work/s5" \
        --ports-file="$work/only.ports" 2>only.log &
    coord_pid=$!
    wait_file "$work/only.ports"
    grep -q '^unix' only.ports && fail "it has a socket nevertheless"
    grep -q 'without the default socket' only.log ||
        fail "the missing socket is not said: $(cat only.log)"
    end_one "$coord_pid" "coordinator without a socket"
fi

# one coordinator a folder, one a socket
cluster_start 1 2
expect 73 "another process" "a second coordinator" \
    "$radcoord" --state="$work/state" --socket= --listen=127.0.0.1:0
expect 73 "in use" "the same socket" \
    "$radcoord" --state="$work/s2" --socket="$sock" --listen=
expect 73 "in use" "the same port" \
    "$radcoord" --state="$work/s3" --socket= --listen="$tcp"
echo text >file
expect 73 "no socket" "a file in the way" \
    "$radcoord" --state="$work/s4" --socket="$work/file" --listen=

expect 64 "at most 65535" "a port that is none" \
    "$radcoord" --state="$work/s5" --socket= --listen=127.0.0.1:99999

# --socket is a path, also where it looks like an address
"$radcoord" --state="$work/s6" --socket=plain:80 --listen= \
    --ports-file="$work/plain.ports" 2>plain.log &
plain_pid=$!
wait_file "$work/plain.ports"
[ -S plain:80 ] || fail "no socket 'plain:80': $(cat plain.log)"
"$radctl" --coordinator=./plain:80 status >/dev/null || fail "nobody at it"
end_one "$plain_pid" "coordinator at a plain name"

# who cannot be reached is named
"$radd" --coordinator="$work/nobody.sock" --cache="$work/c5" \
    --listen=127.0.0.1:0 2>nobody.log &
nobody_pid=$!
until_true 30 grep -q "not reached at=$work/nobody.sock why=" nobody.log ||
    fail "nobody.log: $(cat nobody.log)"
end_one "$nobody_pid" "a worker of nobody"

# a dead socket is replaced, and workers find a coordinator that comes back
kill -KILL "$coord_pid"
[ -S "$sock" ] || fail "the socket went with the coordinator"
wait "$coord_pid" 2>/dev/null
coord_again
until_true 60 n_workers 1 || fail "the worker does not come back"

# asked to stop in the middle of its units a worker gives back what is left of
# them, and nothing of what it did is lost
"$radsubmit" --coordinator="$sock" --name=drain -vf "$scenes/room.vf" -x 400 \
    -y 300 -ps 1 -ds .1 -dj 1 -ab 0 --partition=scanbar --stats=drain.json \
    -o drain.hdr "$scenes/room.rad" 2>stderr &
job=$!
until_true 60 in_the_middle drain || fail "the job does not start"
worker_start 2 2
end_one "$pid_1" "drained worker"
wait $job || fail "drain: $(cat stderr)"
[ "$(total drain.json units_redone)" -eq 0 ] || fail "a drained unit was lost"
grep -q "stopping signal=15" w1.log || fail "worker 1 does not say why it ends"

# settings may change
kill -HUP "$coord_pid"
until_true 10 grep -q reloaded c.log || fail "no reload"
cluster_stop
[ -e "$sock" ] && fail "the socket outlives its coordinator"
finish
