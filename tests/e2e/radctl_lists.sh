#!/bin/sh
# radctl_lists.sh - lists are told whole, however long; what one does not want
# to see any more can be cancelled, deleted and forgotten
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
jobs=250

ctl()
{
    "$radctl" --coordinator="$sock" "$@"
}

as_ana()
{
    "$radctl" --coordinator="$tcp" --key="$work/user.key" "$@"
}

# count N ARGUMENTS...: so many rows, for people and as JSON
count()
{
    want=$1
    shift
    ctl "$@" >rows 2>stderr || fail "$*: $(cat stderr)"
    if [ "$want" -eq 0 ]; then
        grep -qE '^no (jobs|workers|entries)$' rows || fail "$*: $(head -n 3 rows)"
    else
        [ "$(wc -l <rows)" -eq $((want + 1)) ] ||
            fail "$*: $(wc -l <rows) lines, not $want rows and a head"
    fi
    ctl --json "$@" | python3 -c '
import json, sys
rows = json.load(sys.stdin)
names = [r.get("job") or r.get("key") or r["name"] for r in rows]
sys.exit(len(rows) != int(sys.argv[1]) or len(set(names)) != len(rows))' \
        "$want" || fail "$*: as JSON there are not $want rows, each once"
}

coord_options="--keep-jobs=1000 --user-jobs=1000"
cluster_start 1 1
kill -KILL "$pid_1" # it is there for the list
gone_1() { ctl workers --state=gone | grep -q '^w1 '; }
until_true 30 gone_1 || fail "the worker does not go: $(ctl workers)"
workers=
# shellcheck disable=SC2016 # the inner shell's
seq $jobs | xargs -P 4 -n 25 sh -c '
for i in "$@"; do
    "$0" --coordinator="'"$tcp"'" --key="'"$work"'/user.key" --detach \
        --name="job $i" -vf "'"$scenes"'/room.vf" -x 8 -y 8 \
        "'"$scenes"'/room.rad" || exit 1
done' "$radsubmit" >ids 2>stderr || fail "submit: $(tail -n 3 stderr)"
mine=$("$radsubmit" --coordinator="$sock" --detach --name=mine \
    --priority=7 -vf "$scenes/room.vf" -x 8 -y 8 "$scenes/room.rad" 2>stderr) ||
    fail "submit: $(cat stderr)"

count $((jobs + 1)) jobs
sed -n 2p rows | grep -q "^$mine " || fail "who is served first comes first"
count $jobs jobs --user=$ana
count 1 jobs --user="$(id -un)"
count 1 jobs --user="uid:$(id -u)"
count 0 jobs --user=bob
count $((jobs + 1)) jobs --state=open
count 0 jobs --state=over
count 7 jobs --limit=7
count 1 jobs --limit=7 --user="$(id -un)"
count 210 jobs --limit=210
count 1 workers
count 1 workers --state=gone
count 0 workers --state=idle
count 11 key list
count 1 key list --user=ana --state=valid
count 9 key list --limit=9
count 0 key list --state=expired
expect 64 "unknown state 'idle': expected one of waiting, running" "a state" \
    "$radctl" --coordinator="$sock" jobs --state=idle
expect 64 "'0' is not a whole number from 1" "a limit" \
    "$radctl" --coordinator="$sock" jobs --limit=0
expect 64 "option '--state': empty value" "a state that is empty" \
    "$radctl" --coordinator="$sock" jobs --state=
expect 64 "option '--json' takes no value" "a switch with a value" \
    "$radctl" --coordinator="$sock" jobs --json=1
expect 64 "--user goes with" "of workers" \
    "$radctl" --coordinator="$sock" workers --user=$ana

# several by name; what fails is told and does not stop the others
first=$(sed -n 1p ids) second=$(sed -n 2p ids)
as_ana cancel "$first" "$second" || fail "two are not cancelled"
count 2 jobs --state=cancelled
expect 77 "$mine: the job belongs to another user" "of another user" \
    "$radctl" --coordinator="$tcp" --key="$work/user.key" delete "$mine" \
    "$first"
grep -q "delete: 1 of 2 failed" stderr || fail "sum: $(cat stderr)"
count $jobs jobs
expect 64 "the job is not over: cancel it first" "of one that goes on" \
    "$radctl" --coordinator="$sock" delete "$mine"

# all of mine: not those of others
[ "$(as_ana cancel --all)" = "$((jobs - 2)) jobs cancelled" ] ||
    fail "cancel --all"
count 1 jobs --state=open
[ "$(as_ana --json cancel --all)" = '{ "ok": true, "jobs": 0 }' ] ||
    fail "cancel --all again"
expect 77 "belongs to another user" "all of another user" \
    "$radctl" --coordinator="$tcp" --key="$work/user.key" cancel --all \
    --user="$(id -un)"
expect 64 "--all or ID" "all and one" \
    "$radctl" --coordinator="$sock" cancel --all "$mine"
expect 64 "missing ID" "none" "$radctl" --coordinator="$sock" cancel
# an administrator's word for a user
[ "$(ctl delete --all --user=$ana)" = "$((jobs - 1)) jobs deleted" ] ||
    fail "delete --all --user"
count 1 jobs
expect 66 "no such job" "deleted" \
    "$radctl" --coordinator="$sock" fetch "$second" -o x.hdr

expect 77 "for administrators: use --key" "forget by a user" \
    "$radctl" --coordinator="$tcp" --key="$work/user.key" forget w1
expect 66 "no worker 'w7'" "one that never was" \
    "$radctl" --coordinator="$sock" forget w7
ctl drain w1 || fail "drain"
ctl forget w1 || fail "forget"
count 0 workers

# it stays so after a restart
kill -TERM "$coord_pid"
wait "$coord_pid" || fail "the coordinator ended with $?"
coord_start
count 1 jobs
count 0 workers

# a coordinator that is gone before the question comes
cat >deaf.py <<'PY'
import signal, socket, sys
server, coord = socket.socket(socket.AF_UNIX), socket.socket(socket.AF_UNIX)
server.bind("deaf")
server.listen()
coord.connect(sys.argv[1])
user, _ = server.accept()
coord.sendall(user.recv(65536))
user.shutdown(socket.SHUT_RD)
user.sendall(coord.recv(65536))
signal.pause()
PY
python3 deaf.py "$sock" &
deaf=$!
until_true 10 test -S deaf || fail "nobody listens"
expect 69 "no coordinator at" "a coordinator that is gone" \
    "$radctl" --coordinator="$work/deaf" status
kill $deaf

cluster_finish
