#!/bin/sh
# kept_jobs.sh - jobs that are over are kept for each user by themselves, what
# was not fetched longer than the rest, sensor points, too, and what was
# forgotten is told
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

view="-vf $scenes/room.vf -x 8 -y 6 -ps 1 -ds .1 -dj 1 -ab 0
--partition=window --windows=1"
room=$scenes/room.rad

settings() # KEEP_UNFETCHED_DAYS USER_UNFETCHED
{
    cat >c.conf <<END
keep_jobs = 10
keep_unfetched_days = $1
user_unfetched = $2
END
}

ana()
{
    "$radctl" --coordinator="$tcp" --key="$work/user.key" "$@"
}

# states OWNER: how many jobs of that owner are in which state
states()
{
    "$radctl" --coordinator="$sock" --json jobs >now.json
    "$radctl" --coordinator="$sock" --json --state=forgotten jobs >gone.json
    OWNER=$1 python3 -c '
import collections, json, os
rows = json.load(open("now.json")) + json.load(open("gone.json"))
n = collections.Counter(job["state"] for job in rows
                        if job["owner"] == os.environ["OWNER"])
print(" ".join("%s=%d" % pair for pair in sorted(n.items())))'
}

has_states() # OWNER STATES
{
    [ "$(states "$1")" = "$2" ]
}

detach() # N: of ana's, their ids in "ids", and wait for them
{
    : >ids
    i=0
    while [ $i -lt "$1" ]; do
        # shellcheck disable=SC2086 # options are words
        "$radsubmit" --coordinator="$tcp" --key="$work/user.key" --detach \
            $view "$room" >>ids 2>stderr || fail "detach: $(cat stderr)"
        i=$((i + 1))
    done
}

coord_options=--config=$work/c.conf
settings 14 100
cluster_start 1 1
me=$(id -un)

# shellcheck disable=SC2086
mine=$("$radsubmit" --coordinator="$sock" --detach $view "$room" 2>stderr) ||
    fail "mine: $(cat stderr)"
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" $view -o waited.hdr "$room" 2>stderr ||
    fail "one that is waited for: $(cat stderr)"
detach 14
cp ids first
until_true 60 has_states $ana done=14 || fail "ana's: $(states $ana)"
has_states "$me" done=2 || fail "another's jobs went: $(states "$me")"
"$radctl" --coordinator="$sock" jobs >jobs
[ "$(grep -c 'not fetched; kept until 20' jobs)" -eq 15 ] ||
    fail "jobs does not say what is not fetched: $(cat jobs)"

# All of ana's are fetched: in the next life, which knows that, and in which
# nobody is just getting them, four are too many.
while read -r id; do
    ana fetch "$id" -o fetched.hdr || fail "ana's $id cannot be fetched"
done <first
cmp fetched.hdr waited.hdr || fail "a picture differs"
end_one "$coord_pid" coordinator
coord_start
until_true 10 has_states $ana "done=10 forgotten=4" ||
    fail "of those that were fetched ten are kept: $(states $ana)"
has_states "$me" done=2 || fail "another's jobs went: $(states "$me")"
old=$(head -n 1 first)
expect 66 "forgotten for keep_jobs on 20" "fetch" ana fetch "$old" -o gone.hdr
grep -q 'UTC$' stderr ||
    fail "it says that it was not fetched: $(cat stderr)"
expect 66 "forgotten for keep_jobs on 20" "job" ana job "$old"
expect 66 "forgotten for keep_jobs on 20" "an admin's fetch" \
    "$radctl" --coordinator="$sock" fetch "$old" -o gone.hdr
[ ! -d state/jobs/"$old" ] || fail "its folder is there"
[ -z "$(ls -d state/jobs/*.gone 2>/dev/null)" ] || fail "a name of one is left"

# What is not fetched does not go for others, but when its time is over.
end_one "$pid_1" "worker 1"
worker_start 1 1
detach 12
until_true 60 has_states $ana "done=22 forgotten=4" ||
    fail "what was fetched counts with what was not: $(states $ana)"
"$radctl" --coordinator="$sock" fetch "$mine" -o mine.hdr || fail "mine went"
settings 0 100
kill -HUP "$coord_pid"
until_true 10 has_states $ana "done=10 forgotten=16" ||
    fail "SIGHUP does not change it: $(states $ana)"
"$radctl" --coordinator="$sock" jobs >jobs 2>stderr
grep -q '16 jobs are forgotten, the last was forgotten for keep_jobs on 20' \
    stderr || fail "jobs does not tell of them: $(cat stderr)"
"$radctl" --coordinator="$sock" --limit=1 jobs >jobs 2>stderr
grep -q '16 jobs are forgotten' stderr ||
    fail "a limit of rows is one of what is told: $(cat stderr)"
"$radctl" --coordinator="$sock" --state=forgotten jobs >jobs
grep -q '^job  *state  *owner  *name  *note$' jobs ||
    fail "of a forgotten job it tells what nobody knows: $(head -n 2 jobs)"
[ "$(grep -c 'forgotten for keep_jobs on .* UTC, not fetched$' jobs)" -eq 2 ] ||
    fail "jobs does not say that nobody had two: $(cat jobs)"
grep -q 'job forgotten job=.* owner='$ana' why=forgotten for keep_jobs on 20' c.log ||
    fail "the log does not say whose"

# Rather than that something is lost no more is taken.
settings 14 3
kill -HUP "$coord_pid"
full() { ana --json limits | grep -A 2 user_unfetched | grep -q '"most": 3'; }
until_true 10 full || fail "limits does not tell of it: $(ana limits)"
# shellcheck disable=SC2086
expect 75 "limit user_unfetched: you have 10 of 3" "one too many" \
    "$radsubmit" --coordinator="$tcp" --key="$work/user.key" --wait=3 \
    --detach $view "$room"

# Values of sensor points are fetched when radsubmit has them, as pictures are,
# and the next life knows that.
settings 14 12
kill -HUP "$coord_pid"
used() # N: of 12
{
    ana --json limits | grep -A 2 user_unfetched | tr -d ' \n' |
        grep -q "\"used\":$1,\"most\":12,"
}
until_true 10 used 10 || fail "limits before points: $(ana limits)"
printf '1 1 .8 0 0 1\n2 1 .8 0 0 1\n' >points.txt
points()
{
    "$radsubmit" --coordinator="$tcp" --key="$work/user.key" \
        --points=points.txt -h- -I -ab 0 "$@" "$room"
}
for i in 1 2 3; do
    points -o values.txt 2>stderr || fail "points, run $i: $(cat stderr)"
    [ "$(wc -l <values.txt)" -eq 2 ] || fail "run $i: $(cat values.txt)"
done
until_true 10 used 10 || fail "values that were waited for: $(ana limits)"
left=$(points --detach 2>stderr) || fail "points left: $(cat stderr)"
left_unfetched()
{
    ana jobs 2>stderr | grep "$left" | grep -q 'not fetched; kept until'
}
until_true 30 left_unfetched || fail "points left: $(ana jobs)"
until_true 10 used 11 || fail "values that nobody has: $(ana limits)"
points --job="$left" -o again.txt 2>stderr || fail "--job: $(cat stderr)"
cmp values.txt again.txt || fail "--job writes other values"
until_true 10 used 10 || fail "values that --job wrote: $(ana limits)"
left_unfetched && fail "--job: $(ana jobs)"
end_one "$coord_pid" coordinator
coord_start
used 10 || fail "the next life does not know it: $(ana limits)"
end_one "$coord_pid" coordinator

# Days that the machine sleeps count, too,
export DISASTER_SLEPT=$work/slept DISASTER_CLOCK=$work/clock
life() # SECONDS: so far is the system's clock ahead
{
    echo "$1" >clock
    LD_PRELOAD=$top_builddir/tests/tools/disaster.so
    export LD_PRELOAD
    coord_start
    unset LD_PRELOAD
}
echo 0 >slept
life 0
used 10 || fail "before the sleep: $(ana limits)"
echo $((15 * 86400)) >slept
until_true 10 used 0 || fail "after the sleep: $(ana limits)"
# but they make a job no older that was under way, and ended after them
"$radsubmit" --coordinator="$tcp" --key="$work/user.key" --detach $view \
    "$room" >ids 2>stderr || fail "over the sleep: $(cat stderr)"
echo $((45 * 86400)) >slept
worker_start 2 1
until_true 30 used 1 || fail "forgotten with its end: $(ana jobs)"

# A clock that is wrong when a life begins makes no job old, nor does that it is
# put right: two decades ahead, and a dead battery's 1970.
another_life()
{
    end_one "$coord_pid" coordinator
    life "$1"
    used 1 || fail "forgotten by a clock that is $1 s ahead: $(ana jobs)"
}
another_life $((20 * 366 * 86400))
echo 0 >clock # dates that are shown go by it at once
until_year=$(ana jobs | sed -n 's/.*kept until \([0-9]*\)-.*/\1/p')
[ "$until_year" -le $(($(date +%Y) + 1)) ] || fail "kept until $until_year"
another_life 0
another_life $((3600 - $(date +%s)))
grep -q 'clock wrong by_s=' c.log || fail "the log does not tell of 1970"
another_life 0
# Time that radcoord lives counts, all the same.
touch mark
echo $((55 * 86400)) >slept
until_true 10 test state/radcoord.db-wal -nt mark || fail "no date is noted"
another_life $((10 * 86400))
echo $((60 * 86400)) >slept
until_true 10 used 0 || fail "ten days and five count for less: $(ana jobs)"
cluster_finish
