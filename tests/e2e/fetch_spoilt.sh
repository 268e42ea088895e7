#!/bin/sh
# fetch_spoilt.sh - a picture that a disk has cut can be asked for very often,
# and one that is asked for need not be waited for: nothing of that stays in the
# coordinator's memory
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
. "$top_srcdir/tests/e2e/cluster.sh"
set -u
growth_kib=2048
is_sanitized &&
    growth_kib=1000000

# ask JOB TIMES: for its picture, until the coordinator has answered each
ask()
{
    python3 - "$sock" "$1" "$2" <<'END'
import struct, sys, wire
link = wire.Link(sys.argv[1])
fetch = wire.frame(wire.FETCH, bytes.fromhex(sys.argv[2]) + struct.pack(">IB", 0, 0))
for i in range(int(sys.argv[3]) // 100):
    link.s.sendall(100 * fetch)
    n = 0
    while n < 100:
        n += link.receive()[0] == wire.FAILED
END
}

memory()
{
    awk '/^VmRSS:/ { print $2 }' "/proc/$coord_pid/status"
}

cluster_start 1 1
id=$("$radsubmit" --coordinator="$sock" --detach -vf "$scenes/room.vf" -x 16 \
    -y 12 -ab 0 "$scenes/room.rad" 2>stderr) || fail "submit: $(cat stderr)"
is_done() { "$radctl" --coordinator="$sock" jobs | grep -q "^$id *done"; }
until_true 30 is_done || fail "the job does not end"
truncate -s 10 "state/jobs/$id/0.hdr"
ask "$id" 2000 || fail "no answers"
before=$(memory)
ask "$id" 15000 || fail "no answers to many"
after=$(memory)
[ $((after - before)) -le $growth_kib ] ||
    fail "15000 answers leave $((after - before)) KiB"
cluster_stop
finish
