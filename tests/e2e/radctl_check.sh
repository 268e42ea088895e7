#!/bin/sh
# radctl_check.sh - a damaged state folder is refused by radcoord, and radctl
# check says what is wrong with it; a sound one it calls sound
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

view="-vf $scenes/room.vf -x 400 -y 300 -ps 1 -ds .1 -dj 1 -ab 0
--partition=scanbar"

# says WHAT: radctl check finds that, and radcoord does not start
says()
{
    expect 65 "is damaged" "check: $1" "$radctl" check "$work/state"
    grep -q "$1" stdout || fail "check does not say '$1': $(cat stdout)"
    expect 65 "radctl check" "start: $1" "$radcoord" --listen= \
        --socket="$work/other.sock" --state="$work/state"
}

damage()
{
    rm -rf state
    cp -r sound state
}

expect 66 "is no folder" "no folder" "$radctl" check "$work/state"
mkdir other
expect 66 "no state folder" "another folder" "$radctl" check "$work/other"
[ -z "$(ls -A other)" ] || fail "check left something there: $(ls -A other)"
if [ "$(id -u)" -ne 0 ]; then # root may look anywhere
    chmod 0 other
    expect 77 "cannot look into" "a folder of others" \
        "$radctl" check "$work/other"
    chmod 700 other
fi
# a job that gets somewhere and to no end, on a worker with the hooks of tests
cluster_start_looping 70-133
expect 75 "running coordinator" "in use" "$radctl" check "$work/state"
# shellcheck disable=SC2086 # options are words
"$radsubmit" --coordinator="$sock" $view -o first.hdr "$scenes/room.rad" \
    2>stderr || fail "first: $(cat stderr)"
# shellcheck disable=SC2086
id=$("$radsubmit" --coordinator="$sock" --name=half --detach $view \
    loop.rad 2>stderr) || fail "half: $(cat stderr)"
until_true 60 in_the_middle half || fail "the job does not start"
kill -KILL "$coord_pid"
wait "$coord_pid" 2>/dev/null
kill -KILL "$pid_1"
cp -r state sound

"$radctl" check "$work/state" >stdout || fail "sound: $(cat stdout)"
grep -q '^sound: 2 jobs, 1 of them not over; 0 problems' stdout ||
    fail "of a sound folder it says $(cat stdout)"
"$radctl" --json check "$work/state" | python3 -c '
import json, sys
found = json.load(sys.stdin)
sys.exit(not (found["sound"] and found["jobs"] == 2 and
              found["problems"] == []))' || fail "the JSON of a sound folder"
diff -r state sound >diff.out || fail "check changed something: $(cat diff.out)"
chmod go+w state
expect 77 "rights are not as radcoord needs them" "a folder that others change" \
    "$radctl" check "$work/state"
grep -q '^problem: .*chmod go-w$' stdout && grep -q '^not known: .*; 1 problem$' stdout ||
    fail "of a folder that others change it says $(cat stdout)"
chmod go-w state

rm state/jobs/"$id"/0.rows
says "0.rows' is missing"
damage
truncate -s 1000 state/jobs/"$id"/0.rows
says "1000 bytes, expected"
damage
rm state/jobs/*/0.hdr
says "0.hdr' is missing"
damage
# of a job all that is wrong is told
truncate -s 0 state/jobs/*/0.hdr state/jobs/*/stats
says "stats' has 0 bytes, expected"
"$radctl" check "$work/state" >stdout 2>/dev/null
grep -q "0.hdr' has 0 bytes, expected" stdout ||
    fail "the first of two problems: $(cat stdout)"
damage
for f in state/jobs/*/0.hdr state/jobs/*/stats; do
    printf x | dd of="$f" bs=1 seek=30 conv=notrunc 2>dd.err ||
        fail "$(cat dd.err)"
    "$radctl" check "$work/state" >stdout 2>/dev/null &&
        fail "a flipped byte in $f is not seen"
    grep -q "$f' is damaged: its hash is another" stdout ||
        fail "of a flipped byte in $f: $(cat stdout)"
    damage
done
for f in state/files/*; do
    echo tampered >>"$f"
done
says "its hash is another"
damage
# rows that a disk has spoilt are no loss but of time: they are made again
rows=state/jobs/$id/0.rows
dd if=/dev/urandom of="$rows" bs="$(stat -c %s "$rows")" count=1 conv=notrunc \
    2>dd.err || fail "$(cat dd.err)"
"$radctl" check "$work/state" >stdout || fail "spoilt rows: $(cat stdout)"
grep -q "to be made again: job $id: rows of frame 0, unit [0-9]*, are not" \
    stdout || fail "nobody looks at rows: $(cat stdout)"
grep -q '^the rows of [0-9]* units* will be made again' stdout ||
    fail "no word of how many: $(cat stdout)"
coord_start
until_true 10 grep -q "rows damaged job=$id frame=0 unit=" c.log ||
    fail "radcoord does not look at rows: $(tail -n 3 c.log)"
worker_start 1 2
done_half() { "$radctl" --coordinator="$sock" fetch "$id" -o half.hdr; }
until_true 60 done_half || fail "the job does not end"
# the scenes' names differ
body first.hdr >first.body
body half.hdr | cmp first.body - || fail "spoilt rows are in the picture"
cluster_stop
damage
# a job whose rows were given up, for it was cancelled on a full disk where that
# could not be noted, is over
mv "$rows" "state/jobs/$id/over"
: >"state/jobs/$id/over"
"$radctl" check "$work/state" >stdout || fail "given up: $(cat stdout)"
grep -q 'sound: 2 jobs, 0 of them not over' stdout ||
    fail "a job that was given up is not over: $(cat stdout)"
coord_start
until_true 10 grep -q "job over job=$id state=cancelled" c.log ||
    fail "a job that was given up goes on: $(tail -n 3 c.log)"
is_noted() { [ ! -e "state/jobs/$id/over" ]; }
until_true 10 is_noted || fail "the end of what was given up is not noted"
kill -TERM "$coord_pid"
wait "$coord_pid"
damage
rm state/radcoord.db*
says "but no database"
damage
rm -f state/radcoord.db-wal
head -c 5000 /dev/urandom >state/radcoord.db
says "database"
damage

# the sound one starts, and the picture of the job that was over is still there;
# a scene's file that no job needs is not for long
old=state/files/$(printf '%064d' 7)
echo nobody\'s >"$old"
touch -d '2 days ago' "$old"
files=$(find state/files -type f | wc -l)
"$radcoord" --listen= --socket="$sock" --state="$work/state" 2>>c.log &
coord_pid=$!
there() { "$radctl" --coordinator="$sock" status; }
until_true 30 there || fail "a sound folder does not start: $(tail -n 3 c.log)"
first=$("$radctl" --coordinator="$sock" --json jobs | python3 -c '
import json, sys
print([job["job"] for job in json.load(sys.stdin) if job["state"] == "done"][0])')
"$radctl" --coordinator="$sock" fetch "$first" -o fetched.hdr ||
    fail "the picture of an earlier life cannot be fetched"
cmp first.hdr fetched.hdr || fail "the picture of an earlier life differs"
"$radctl" --coordinator="$sock" --json job "$first" >stats.json ||
    fail "no statistics of an earlier life"
[ "$(total stats.json primary_rays)" -gt 0 ] || fail "they are empty"
no_old() { [ ! -e "$old" ]; }
until_true 10 no_old || fail "a file that nobody needs stays"
[ "$(find state/files -type f | wc -l)" -eq $((files - 1)) ] ||
    fail "files of jobs went with it"
kill -TERM "$coord_pid"
wait "$coord_pid" || fail "the coordinator ended with $?"

# where SQLite has the user's version in its header
set_version()
{
    # shellcheck disable=SC2059
    printf "\\$(printf %03o "$1")" |
        dd of=state/radcoord.db bs=1 seek=63 conv=notrunc 2>dd.err ||
        fail "$(cat dd.err)"
}

# SQLite cannot read it there, which is no damage
if [ "$(id -u)" -eq 0 ] && mount --bind state state 2>/dev/null; then
    mount -o remount,bind,ro state || fail "no read-only file system"
    expect 74 "on a read-only file system" "a read-only file system" \
        "$radctl" check "$work/state"
    umount state
else
    echo "a read-only file system is left out: only root may mount one"
fi

# one that an older or a newer release made is not damaged, and stays as it is
schema=$(od -An -tu1 -j63 -N1 state/radcoord.db)
for version in $((schema - 1)) $((schema + 1)); do
    set_version $version
    cp state/radcoord.db before.db
    says_version()
    {
        expect 65 "radcoord.db: database: of version $version, made by" "$@"
        ! grep -q damaged stderr || fail "$1: it is called damaged"
    }
    says_version "check $version" "$radctl" check "$work/state"
    says_version "start $version" "$radcoord" --listen= \
        --socket="$work/other.sock" --state="$work/state"
    cmp before.db state/radcoord.db || fail "version $version: it is changed"
done
finish
