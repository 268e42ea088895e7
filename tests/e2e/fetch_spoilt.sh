#!/bin/sh
# fetch_spoilt.sh - a picture that a disk has cut can be asked for very often,
# and one that is asked for need not be waited for: nothing of that stays in the
# coordinator's memory; a scene that it has spoilt fails its job
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
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

# of a scene that the disk has spoilt the job says so, by status 74
# shellcheck disable=SC2154 # set by worker_start
end_one "$pid_1" "the worker"
printf 'void glow g 0 0 4 1 1 1 0\ng sphere s 0 0 4 2 4 1 1\n' >ball.rad
id=$("$radsubmit" --coordinator="$sock" --detach -vf "$scenes/room.vf" -x 8 \
    -y 6 -ab 0 ball.rad 2>stderr) || fail "submit: $(cat stderr)"
for file in state/files/*; do
    printf 'spoilt' | dd of="$file" conv=notrunc 2>/dev/null
done
worker_start 2 1
is_failed() { "$radctl" --coordinator="$sock" jobs | grep -q "^$id *failed"; }
until_true 60 is_failed || fail "the job of a spoilt scene does not end"
"$radctl" --coordinator="$sock" --json job "$id" >job.json
grep -q '"status": 74' job.json && grep -q 'copy is spoilt' job.json ||
    fail "a spoilt scene: $(cat job.json)"
cluster_finish
