#!/bin/sh
# cluster_peers.sh - workers of one machine without a key file: they reach the
# coordinator by its Unix socket and each other over loopback, by keys that it
# makes for each pair and job; nobody else gets in there
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

sock=$work/c.sock
"$radcoord" --listen=127.0.0.1:0 --socket="$sock" --state="$work/state" \
    --ports-file=c.ports 2>c.log &
coord_pid=$!
wait_file c.ports
grep -q 'nobody can come over tcp' c.log || fail "it does not say who may come"
tcp=$(sed -n 's/^tcp //p' c.ports)
for k in 1 2 3; do
    "$radd" --coordinator="$sock" --name="w$k" --threads=1 --log-level=debug \
        --listen="127.0.0.$k:0" --cache="$work/w$k" --ports-file="w$k.ports" \
        2>"w$k.log" &
    eval "pid_$k=$!"
    workers="$workers $k"
done
until_true 30 n_workers 3 || fail "the workers do not come"

all_linked()
{
    [ "$(cat w?.log | grep -c 'peer linked')" -ge 6 ]
}
# on a busy machine one may have ended before all are there
for _ in 1 2 3 4 5 6 7 8; do
    for k in 1 2 3; do
        : >w$k.log
    done
    "$radsubmit" --coordinator="$sock" -vf "$scenes/room.vf" -x 160 -y 120 -ab 1 \
        --ambient=live -ad 64 -as 0 -aa .2 --partition=scanbar --stats=s.json \
        -o room.hdr "$scenes/room.rad" 2>stderr || fail "the job: $(cat stderr)"
    grep 'connection refused' w?.log && fail "a link was refused"
    all_linked && [ "$(total s.json ambient_received)" -gt 0 ] && break
done
all_linked || fail "they are not all linked"
[ "$(total s.json ambient_received)" -gt 0 ] || fail "no records went over"

# a key of whatever file is none there, nor is anything else
make_keys
where=$(sed -n 's/^tcp //p' w1.ports)
expect 77 "does not take the key" "an admin's key at a worker" \
    "$radctl" --coordinator="$where" --key=admin.key status
until_true 5 grep -q "refused peer=127.*unknown key 'admin:root:k1'" w1.log ||
    fail "the log: $(tail -n 3 w1.log)"
expect 77 "does not take the key" "a key at a coordinator without any" \
    "$radctl" --coordinator="$tcp" --key=admin.key status
"$radctl" --coordinator="$sock" key list >list 2>stderr && fail "a list of keys"
grep -q 'without a key file' stderr || fail "key list: $(cat stderr)"

# without a key other machines are not even called
expect 77 "--key" "a worker without a key" \
    "$radd" --coordinator=192.0.2.1:7420 --cache="$work/x" --listen=127.0.0.1:0
expect 66 "nowhere" "a key file that is not there" \
    "$radd" --coordinator="$tcp" --key=nowhere --cache="$work/x"
expect 66 "nowhere" "keys that are not there" \
    "$radcoord" --keys=nowhere --socket= --listen=127.0.0.1:0 --state="$work/y"
chmod 644 w9.key
expect 77 "chmod 600" "a key that all may read" \
    "$radd" --coordinator="$tcp" --key=w9.key --cache="$work/x"
# with keys any address will do
"$radcoord" --keys=keys --socket= --listen=0.0.0.0:0 --state="$work/y" \
    --ports-file=any.ports 2>any.log &
any=$!
wait_file any.ports
port=$(sed -n 's/^tcp 0.0.0.0://p' any.ports)
"$radctl" --coordinator="127.0.0.1:$port" --key=user.key status >/dev/null ||
    fail "it does not listen on all addresses"
# a worker that listens on all of its addresses is dialled where it came from
"$radd" --coordinator="127.0.0.1:$port" --key=w8.key --threads=1 \
    --listen=0.0.0.0:0 --cache="$work/w8" 2>w8.log &
eight=$!
there() { "$radctl" --coordinator="127.0.0.1:$port" --key=user.key --json \
    workers | grep -q '"w8"'; }
until_true 20 there || fail "w8 does not come: $(tail -n 3 w8.log)"
end_one $eight "worker 8"
end_one $any "the coordinator for all"
cluster_finish
