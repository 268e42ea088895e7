#!/bin/sh
# storm.sh - job after job while workers and children are killed, restarted and
# made to stand still: every picture is right, and whoever lives through it has
# no more memory, descriptors or threads in the end than at the beginning
#
# The coordinator and worker 1 live through it; all others and every child may
# be struck.  RADD_SOAK=long is an hour of eight workers, at least 500 jobs, and
# a blow every 5 s; STORM_SECONDS, STORM_JOBS, STORM_WORKERS, STORM_EVERY change
# one each.  What happens is drawn from STORM_SEED, which is printed.
#
# What they hold is looked at when no job is left: after STORM_WARM jobs, which
# fill pools, caches and what is kept of jobs that are over, and at the end.
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/chance.sh"

if [ "${RADD_SOAK:-}" = long ]; then
    : "${STORM_SECONDS:=3600}" "${STORM_JOBS:=500}" "${STORM_WORKERS:=8}"
    : "${STORM_EVERY:=5}" "${STORM_WARM:=120}"
else
    : "${STORM_SECONDS:=6}" "${STORM_JOBS:=8}" "${STORM_WORKERS:=3}"
    : "${STORM_EVERY:=1}" "${STORM_WARM:=10}"
fi
draw_from "${STORM_SEED:-}"

# --- jobs ---

reading=$top_srcdir/examples/reading-room
where="-vf room.vf -x 160 -y 120 -ps 4 -ds .1 -dj .7 -pj .7 -ab 0"
parts="auto scanbar static window"

# render PARTITION OUT OPTION...
render()
{
    part=$1 out=$2
    shift 2
    # shellcheck disable=SC2086 # options are words
    (cd "$reading" && exec "$radsubmit" $where --partition="$part" \
        -o "$out" "$@" room.rad) 2>"$out.err" </dev/null
}

# stream NUMBER: one job after the other; what is wrong goes to $work/wrong
stream()
{
    state=$((state + $1)) picture=$work/stream$1.hdr
    while ! [ -e "$work/enough" ]; do
        # shellcheck disable=SC2086 # words
        one_of $parts
        if ! render "$word" "$picture" --coordinator="$sock"; then
            echo "$word: $(cat "$picture.err")" >>"$work/wrong"
        elif ! cmp -s "$picture" "$work/$word.hdr"; then
            echo "a picture by $word differs" >>"$work/wrong"
        fi
        [ -s "$work/wrong" ] && break
        rm -f "$picture"
        echo "$word" >>"$work/jobs"
    done
}

# --- blows ---

worker_pid()
{
    eval "echo \$pid_$1"
}

blow()
{
    any $((STORM_WORKERS - 1))
    k=$((any + 2))
    any 4
    case $any in
    0)
        kill -KILL "$(worker_pid $k)"
        wait "$(worker_pid $k)" 2>/dev/null
        worker_start $k 1
        ;;
    1) # it stands still for a while, and its children do not
        kill -STOP "$(worker_pid $k)"
        sleep .5
        kill -CONT "$(worker_pid $k)"
        ;;
    *)
        any "$STORM_WORKERS"
        child_of $((any + 1)) | head -n 1 | xargs -r kill -KILL 2>/dev/null
        ;;
    esac
}

# --- what the survivors hold ---

# held PID: memory [KiB], descriptors, threads
held()
{
    echo "$(sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$1/status")" \
        "$(ls "/proc/$1/fd" | wc -l)" "$(ls "/proc/$1/task" | wc -l)"
}

at_rest()
{
    n_workers "$STORM_WORKERS" && no_child 1
}

# Jobs that are remembered: beside those that are kept all of the last minute,
# for their users may be getting what is left of them.
remembered()
{
    "$radctl" --coordinator="$sock" jobs --json | grep -c '"state"'
}

# no_more NAME PID: than in NAME.held, but for 1 MiB an hour, and JOB_KIB for
# each job more that is remembered; as_before leaves in $now what it is
JOB_KIB=48
as_before()
{
    now=$(held "$2")
    echo "$now $(cat "$1.held") $(($(remembered) - $(cat remembered)))" |
        awk -v hours="$hours" -v a_job=$JOB_KIB '{
        room = 1024 * (hours < 1 ? 1 : hours) + a_job * ($7 > 0 ? $7 : 0)
        exit !($1 - $4 <= room && $2 <= $5 && $3 <= $6)
    }'
}

no_more()
{
    until_true 20 as_before "$1" "$2" || fail "$1 holds more and more"
    echo "$1: KiB, descriptors, threads: $(cat "$1.held"), then $now"
}

# streams COMMAND...: two of them, and meanwhile that again and again until it
# fails
streams()
{
    rm -f enough
    : >jobs
    stream 1 &
    first=$!
    stream 2 &
    second=$!
    while [ ! -s wrong ] && "$@"; do
        :
    done
    touch enough
    wait $first
    wait $second
    [ -s wrong ] && fail "$(head -n 5 wrong)"
    until_true 60 at_rest || fail "the cluster does not come to rest"
}

warming()
{
    sleep .2
    [ "$(wc -l <jobs)" -lt "$STORM_WARM" ]
}

storming()
{
    sleep "$STORM_EVERY"
    blow
    blows=$((blows + 1))
    [ "$(date +%s)" -lt "$ends" ] || [ "$(wc -l <jobs)" -lt "$STORM_JOBS" ]
}

# --- the storm ---

for part in $parts; do
    render "$part" "$work/$part.hdr" --local --workers=1 --threads=1 ||
        fail "alone, $part: $(cat "$work/$part.hdr.err")"
done
[ $failed -eq 0 ] || finish

# what is freed goes back to the system at once, so that memory is what is held
# and not what was held in the worst moment
export MALLOC_MMAP_THRESHOLD_=16384 MALLOC_TRIM_THRESHOLD_=16384
# as many jobs that are over are remembered at the end as after the warming,
# however many the machine gets through meanwhile
# shellcheck disable=SC2034 # of cluster_start
coord_options="--keep-jobs=$STORM_WARM"
cluster_start "$STORM_WORKERS" 1
touch wrong
streams warming
held "$coord_pid" >coordinator.held
held "$pid_1" >worker.held
remembered >remembered
blows=0
begin=$(date +%s)
ends=$((begin + STORM_SECONDS))
streams storming
hours=$(awk -v s=$(($(date +%s) - begin)) 'BEGIN { print s / 3600 }')
echo "$(wc -l <jobs) jobs, $STORM_WORKERS workers, $blows blows in $hours h"
no_more coordinator "$coord_pid"
no_more worker "$pid_1"
cluster_finish
