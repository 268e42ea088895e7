#!/bin/sh
# storm.sh - job after job while workers and children are killed, restarted and
# made to stand still: every picture is right, and whoever lives through it has
# no more memory, descriptors or threads in the end than at the beginning
#
# The coordinator and worker 1 live through it; all others and every child may
# be struck.  RADD_SOAK=long is an hour of eight workers, at least 500 jobs, and
# a blow every 5 s; STORM_SECONDS, STORM_JOBS, STORM_WORKERS, STORM_EVERY change
# one each.  What happens is drawn from STORM_SEED, which is printed.
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
. "$top_srcdir/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/chance.sh"
set -u

if [ "${RADD_SOAK:-}" = long ]; then
    : "${STORM_SECONDS:=3600}" "${STORM_JOBS:=500}" "${STORM_WORKERS:=8}"
    : "${STORM_EVERY:=5}"
else
    : "${STORM_SECONDS:=6}" "${STORM_JOBS:=8}" "${STORM_WORKERS:=3}"
    : "${STORM_EVERY:=1}"
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
    done=0 state=$((state + $1)) picture=$work/stream$1.hdr
    while [ "$done" -lt $((STORM_JOBS / 2)) ] || ! [ -e "$work/enough" ]; do
        # shellcheck disable=SC2086 # words
        one_of $parts
        if ! render "$word" "$picture" --coordinator="$sock"; then
            echo "$word: $(cat "$picture.err")" >>"$work/wrong"
        elif ! cmp -s "$picture" "$work/$word.hdr"; then
            echo "a picture by $word differs" >>"$work/wrong"
        fi
        [ -s "$work/wrong" ] && break
        rm -f "$picture"
        done=$((done + 1))
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

# held PID: seconds, memory [KiB], descriptors, threads
held()
{
    echo "$(cut -d ' ' -f 1 /proc/uptime)" \
        "$(sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$1/status")" \
        "$(ls "/proc/$1/fd" | wc -l)" \
        "$(ls "/proc/$1/task" | wc -l)"
}

watch()
{
    held "$coord_pid" >>coord.held
    held "$pid_1" >>worker.held
}

# What grew, from the first third to the last, by the least of each: between
# jobs nothing is held.  Memory may grow by 1 MiB an hour, and by what the first
# jobs leave in the allocator's pools.
check_held()
{
    awk -v who="$1" '
    { t[NR] = $1; kib[NR] = $2; fd[NR] = $3; task[NR] = $4 }
    function least(v, from, to,    i, x) {
        x = v[from]
        for (i = from; i <= to; i++)
            if (v[i] < x)
                x = v[i]
        return x
    }
    END {
        a = int(NR / 3); b = NR - a
        if (a < 2) { print who ": too few samples"; exit 1 }
        hours = (t[NR] - t[1]) / 3600
        grown = least(kib, b, NR) - least(kib, 1, a)
        printf "%s: %d KiB, %+d KiB in %.2f h; descriptors %d, %+d; " \
            "threads %d, %+d\n", who, least(kib, b, NR), grown, hours,
            least(fd, b, NR), least(fd, b, NR) - least(fd, 1, a),
            least(task, b, NR), least(task, b, NR) - least(task, 1, a)
        if (grown > 1024 * (hours < 1 ? 1 : hours) ||
            least(fd, b, NR) > least(fd, 1, a) ||
            least(task, b, NR) > least(task, 1, a))
            exit 1
    }' "$2" || fail "$1 holds more and more"
}

# --- the storm ---

for part in $parts; do
    render "$part" "$work/$part.hdr" --local --workers=1 --threads=1 ||
        fail "alone, $part: $(cat "$work/$part.hdr.err")"
done
[ $failed -eq 0 ] || finish

cluster_start "$STORM_WORKERS" 1
touch wrong jobs
stream 1 &
first=$!
stream 2 &
second=$!
ends=$(($(date +%s) + STORM_SECONDS))
while [ "$(date +%s)" -lt "$ends" ] || [ "$(wc -l <jobs)" -lt "$STORM_JOBS" ]; do
    sleep "$STORM_EVERY"
    watch
    blow
    [ -s wrong ] && break
done
touch enough
wait $first
wait $second
watch
[ -s wrong ] && fail "$(head -n 5 wrong)"
echo "$(wc -l <jobs) jobs, $STORM_WORKERS workers"
check_held coordinator coord.held
check_held worker worker.held
cluster_stop
finish
