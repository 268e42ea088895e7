#!/bin/sh
# kills.sh - a worker, or a child, is killed at this or that moment of a job: the
# picture is the undisturbed one's, no more units are done again than were with
# the one who was killed, and where units are parts of one picture (auto) not a
# primary ray is traced twice
#
# Two kills of each; RADD_SOAK=long: 200 of workers and 100 of children.
# KILLS_WORKERS, KILLS_CHILDREN change that, KILLS_SEED, which is printed, what
# is drawn.
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/chance.sh"

if [ "${RADD_SOAK:-}" = long ]; then
    : "${KILLS_WORKERS:=200}" "${KILLS_CHILDREN:=100}"
else
    : "${KILLS_WORKERS:=2}" "${KILLS_CHILDREN:=2}"
fi
draw_from "${KILLS_SEED:-}"

room=$scenes/room.rad
view="-vf $scenes/room.vf -x 200 -y 150 -ps 4 -ds .1 -dj .7 -pj .7 -ab 0"

# submit PART OUT
submit()
{
    how=$1
    [ "$how" != window ] || how='window --windows=24'
    # shellcheck disable=SC2086 # options are words
    exec "$radsubmit" --coordinator="$sock" $view --partition=$how \
        --stats="$2.json" -o "$2.hdr" "$room"
}

# How many units were with worker $1 when it, or its child, was lost.
in_flight()
{
    awk -v who="worker=w$1" -v name="name=w$1" '
    function unit(    i) {
        for (i = 1; i <= NF; i++)
            if ($i ~ /^unit=/)
                return $i
    }
    / unit out / && index($0, who " ") { out[unit()] = 1 }
    / unit done / && $NF == who { delete out[unit()] }
    / child lost / && index($0, who " ") { exit }
    / connection lost / && index($0, name " ") { exit }
    END { for (u in out) n++; print n + 0 }' c.log
}

# strike WHOM: once, in the middle of a job; $struck says whether it was
strike()
{
    one_of auto auto window
    part=$word
    any 3
    k=$((any + 1))
    any $span
    moment=$any
    say="$part, $1 $k at moment $moment"
    struck=
    : >c.log
    submit "$part" job >/dev/null 2>job.err </dev/null &
    job=$!
    until grep -q 'unit out' c.log || gone $job; do
        sleep .01
    done
    n=0
    while [ $n -lt "$moment" ] && ! gone $job; do
        sleep .01
        n=$((n + 1))
    done
    case $1 in
    worker)
        gone $job || struck=yes
        eval "kill -KILL \$pid_$k; wait \$pid_$k 2>/dev/null"
        ;;
    child)
        victim=$(child_of $k) && kill -KILL "$victim" 2>/dev/null && struck=yes
        ;;
    esac
    wait $job || fail "$say: $(cat job.err)"
    flight=$(in_flight $k)
    cmp "$part.hdr" job.hdr || fail "$say: another picture"
    redone=$(total job.json units_redone)
    [ "$redone" -le "$flight" ] ||
        fail "$say: $redone units again, $flight were with it"
    rays=$(total job.json primary_rays)
    [ "$part" = window ] || [ "$rays" = "$primary" ] ||
        fail "$say: $rays primary rays, not $primary"
    grep 'duplicate differs' c.log && fail "$say: results differ"
    if [ "$1" = worker ]; then
        worker_start $k 1
    fi
    until_true 30 n_workers 3 || fail "$say: a worker is missing"
}

# strikes WHOM N: until so many were struck with a unit in hand.  Who strikes too
# late, for there is nothing left to do, strikes sooner the next time.
strikes()
{
    hits=0 idle=0 again=0 span=60
    while [ $hits -lt "$2" ] && [ $failed -eq 0 ]; do
        strike "$1"
        if [ -n "$struck" ] && [ "$flight" -gt 0 ]; then
            hits=$((hits + 1))
            again=$((again + redone))
            span=60
        else
            idle=$((idle + 1))
            span=$((span / 2 + 1))
        fi
        [ $idle -lt $((50 + 10 * $2)) ] || fail "no $1 has anything in hand"
    done
    echo "$1: $hits killed, $idle times with nothing in hand;" \
        "$again units done again"
}

coord_options='--log-level=debug'
cluster_start 3 1
for part in auto window; do
    (submit $part $part) >/dev/null 2>calm.err </dev/null ||
        fail "calm: $(cat calm.err)"
done
primary=$(total auto.json primary_rays)
[ "$primary" -gt 0 ] || fail "the calm job has no primary rays"
strikes worker "$KILLS_WORKERS"
strikes child "$KILLS_CHILDREN"
[ $failed -eq 0 ] || tail -n 40 c.log
cluster_finish
