#!/bin/sh
# garbage.sh - strangers by the thousand, and garbage behind right keys, while a
# job renders: the job ends unharmed, the daemons' memory grows by less than
# 16 MiB beside what jobs that end take, their descriptors return to the start; and
# while slow strangers hold what they can, a new worker joins at its third dial at
# the latest
#
# RADD_SOAK=long: 100000 connections, 100000 frames, 500 slow ones.
# GARBAGE_CONNECTIONS, GARBAGE_FRAMES, GARBAGE_LORIS.
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

if [ "${RADD_SOAK:-}" = long ]; then
    : "${GARBAGE_CONNECTIONS:=100000}" "${GARBAGE_FRAMES:=100000}"
    : "${GARBAGE_LORIS:=500}"
else
    : "${GARBAGE_CONNECTIONS:=2000}" "${GARBAGE_FRAMES:=2000}"
    : "${GARBAGE_LORIS:=500}"
fi
flood=$top_builddir/tests/tools/flood
growth_kib=16384
# and for each job that ended meanwhile and is remembered
job_kib=24
remembered()
{
    "$radctl" --coordinator="$sock" jobs --json | grep -c '"state"'
}

memory()
{
    sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$1/status"
}

descriptors()
{
    ls "/proc/$1/fd" | wc -l
}

# note NAME PID: how it is at the start
note()
{
    eval "memory_$1=$(memory "$2") fds_$1=$(descriptors "$2") process_$1=$2"
}

as_before()
{
    eval "[ \$(descriptors \$process_$1) -le \$fds_$1 ]"
}

# What connections held goes back to the system a while after they have ended.
small_again()
{
    eval "grown=\$((\$(memory \$process_$1) - memory_$1))"
    more=$(($(remembered) - jobs_before))
    [ "$grown" -lt $((growth_kib + more * job_kib)) ]
}

# compare NAME
compare()
{
    until_true 20 as_before "$1" || fail "$1 keeps descriptors open"
    until_true 20 small_again "$1" || fail "$1 has grown by $grown KiB"
    echo "$1: $grown KiB more, and $more jobs"
}

cluster_start 2 1
make_key user:spoiler spoiler.key
make_key worker:spoiler badworker.key
peer=$(sed -n 's/^tcp //p' w1.ports)
view="-vf $scenes/room.vf -x 160 -y 120 -ab 0 -ps 2"
# a first job, so that what a job leaves behind is there
# shellcheck disable=SC2086 # options are words
"$radsubmit" --coordinator="$sock" $view -o calm.hdr "$scenes/room.rad" \
    2>stderr || fail "calm: $(cat stderr)"
"$flood" garbage 200 "$tcp" && "$flood" garbage 200 "$peer"
"$flood" frames 200 "$tcp" spoiler.key
until_true 10 grep -q 'key changed\|key file changed' c.log
note coordinator "$coord_pid"
note worker "$pid_1"
jobs_before=$(remembered)

# jobs, one after the other, until the floods are over
jobs_on()
{
    while [ ! -e stop ]; do
        # shellcheck disable=SC2086
        "$radsubmit" --coordinator="$sock" $view -o storm.hdr \
            "$scenes/room.rad" 2>storm.err || echo "failed: $(cat storm.err)"
        cmp calm.hdr storm.hdr || echo "the picture differs"
        echo >>rendered
    done
}
jobs_on >wrong 2>&1 &
jobs=$!
"$flood" garbage "$GARBAGE_CONNECTIONS" "$tcp" || fail "garbage: $?"
"$flood" garbage "$((GARBAGE_CONNECTIONS / 4))" "$peer" || fail "garbage: $?"
"$flood" frames "$((GARBAGE_FRAMES / 2))" "$tcp" spoiler.key ||
    fail "frames of a user: $?"
"$flood" frames "$((GARBAGE_FRAMES / 2))" "$tcp" badworker.key ||
    fail "frames of a worker: $?"
touch stop
wait $jobs
[ -s rendered ] || fail "no job came to its end"
[ -s wrong ] && fail "jobs: $(cat wrong)"
compare coordinator
compare worker

# 500 who say nothing, and a worker that wants to join
"$flood" loris "$GARBAGE_LORIS" "$tcp" >loris.out &
loris=$!
until_true 30 grep -q ready loris.out || fail "the slow ones do not come"
joined() { "$radctl" --coordinator="$sock" --json workers | grep -q '"w3"'; }
worker_start 3 1
until_true 2 joined || fail "no worker joins beside them"
dials=$(grep -c 'coordinator .* at=' w3.log)
[ "$dials" -le 2 ] || fail "a worker dialled $dials times before it joined"
[ "$(descriptors "$coord_pid")" -le $((fds_coordinator + 64 + 8)) ] ||
    fail "$(descriptors "$coord_pid") descriptors with slow strangers"
kill $loris
wait $loris 2>/dev/null
idle_workers()
{
    [ "$("$radctl" --coordinator="$sock" --json workers |
        grep -c '"idle"')" -eq 3 ]
}
until_true 20 idle_workers || fail "the workers are not there"
[ "$(grep -c 'refused peer' c.log)" -lt 2000 ] || fail "the log is flooded"
[ "${RADD_SOAK:-}" != long ] || grep -q 'not logged n=' c.log ||
    fail "what was not logged is not said"
cluster_finish
