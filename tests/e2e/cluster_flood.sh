#!/bin/sh
# cluster_flood.sh - a user who asks and asks and never reads an answer costs
# the coordinator little memory, and is let go; what a user may have is said,
# set anew while the coordinator runs, and refused above that
#
# A user's flood of all kinds is in tests/soak/userflood.sh.
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

echo 'user_jobs = 1' >c.conf
coord_options="--config=$work/c.conf --upload-s=60"
cluster_start 1 1

# limit USER NAME: what that user may have
limit()
{
    "$radctl" --coordinator="$sock" --json --user="$1" limits | python3 -c '
import json, sys
for row in json.load(sys.stdin)["limits"]:
    if row["limit"] == sys.argv[1]:
        print(row["most"])' "$2"
}
submit() # OPTION...
{
    "$radsubmit" --coordinator="$tcp" --key=user.key --detach "$@" \
        -x 2000 -y 2000 -ab 3 -aa 0 -ad 64 -as 0 "$scenes/room.rad"
}
may_have()
{
    [ "$(limit ana user_jobs)" = "$1" ]
}
may_have 1 || fail "ana may have $(limit ana user_jobs) jobs"
submit >job 2>stderr || fail "a first job: $(cat stderr)"
expect 75 'limit user_jobs: you have 1 of 1 jobs' "a second job" submit --wait=3
printf 'user_jobs = 2\nuser_frames = 3\n' >c.conf
for i in 1 2 3 4; do
    echo "rview -vtv -vp 1 1 $i -vd 0 1 0 -vu 0 0 1 -vh 50 -vv 40"
done >views
kill -HUP "$coord_pid"
until_true 10 may_have 2 || fail "ana may have $(limit ana user_jobs) jobs"
submit >second 2>stderr || fail "a second job: $(cat stderr)"
expect 65 'limit user_frames: ' "an animation" "$radsubmit" \
    --coordinator="$tcp" --key=user.key --detach -x 8 -y 8 -S 1 \
    --views=views "$scenes/room.rad"
expect 77 'for administrators' "another's limits" "$radctl" \
    --coordinator="$tcp" --key=user.key --user=bob limits
"$radctl" --coordinator="$tcp" --key=user.key limits >limits ||
    fail "ana does not hear her limits"
grep -q '^user_jobs  *2  *2  *jobs that are not over' limits ||
    fail "ana's limits: $(cat limits)"
# with time to wait all of a script come in turn, each told of it once at most
seq 6 | xargs -P6 -I{} sh -c '"$0" --coordinator="$1" --key=user.key --wait=300 \
    -x 8 -y 8 -o turn{}.hdr "$2/room.rad" 2>turn{}.err' \
    "$radsubmit" "$tcp" "$scenes" &
six=$!
waits() { grep -q 'limit user_jobs: you have .*; trying again for 300 s$' turn*.err; }
until_true 30 waits || fail "none has to wait"
for file in job second; do
    "$radctl" --coordinator="$tcp" --key=user.key cancel "$(cat $file)" ||
        fail "cancel"
done
wait $six || fail "six at once: $(cat turn*.err)"
for i in 1 2 3 4 5 6; do
    [ -s turn$i.hdr ] || fail "picture $i is not there"
    [ "$(grep -c 'trying again for 300 s' turn$i.err)" -le 1 ] ||
        fail "$i says it again: $(cat turn$i.err)"
done
python3 - "$sock" "$coord_pid" <<'PYTHON' || fail "the flood: see above"
import sys, wire

def resident_mib():
    with open(f'/proc/{sys.argv[2]}/status') as f:
        for line in f:
            if line.startswith('VmRSS:'):
                return int(line.split()[1]) / 1024

queries = wire.frame(wire.QUERY, b'\1' + wire.text(b'')) * 3000
before = resident_mib()
s = wire.Link(sys.argv[1]).s
s.settimeout(2) # it may be made to wait for ever
asked = 0
try:
    while asked < 300 * 3000:
        s.sendall(queries)
        asked += 3000
except OSError: # a timeout, too
    pass
grown = resident_mib() - before
print(f'{asked} questions, {grown:.0f} MiB more')
# answers to all of them would be 340 MiB; a sanitizer keeps freed ones
sys.exit(grown > 200)
PYTHON
until_true 30 n_workers 1 || fail "the worker is not there any more"
cluster_finish
