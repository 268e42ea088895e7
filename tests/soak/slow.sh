#!/bin/sh
# slow.sh - under auto a worker that is 20 times slower than the other three
# costs at most a quarter more time than its absence would
#
# The real scheduler drives simulated hosts, so that time is the simulation's and
# not that of a busy machine.  RADD_SOAK=long tries more sizes, and workers from
# 2 to 1000 times slower.
: "${top_builddir:=.}"
sim=$top_builddir/bench/sim/sim
failed=0

# speed_up HOSTS OPTION...: of auto
speed_up()
{
    hosts=$1
    shift
    "$sim" --ways=auto --hosts="$hosts" "$@" |
        awk -v n="$hosts" '$1 == n && NF == 3 { print $2 }'
}

# compare SIZE FACTOR OPTION...
compare()
{
    size=$1 factor=$2
    shift 2
    without=$(speed_up 3 --size="$size" "$@")
    with=$(speed_up 4 --size="$size" --slow="$factor" "$@")
    awk -v a="$without" -v b="$with" -v what="$size, $factor times slower $*" '
    BEGIN {
        ok = a > 1 && b > 0 && a / b <= 1.25
        printf("%s: %.3f times the time%s\n", what, (b > 0 ? a / b : 0),
            (ok ? "" : " FAIL"))
        exit !ok
    }' || failed=1
}

if [ "${RADD_SOAK:-}" = long ]; then
    for size in 320x240 640x480 1280x720 1920x1280 3840x2160; do
        for factor in 2 3 5 10 20 50 200 1000; do
            compare "$size" "$factor"
        done
        compare "$size" 20 --frames=5
        compare "$size" 20 --uneven=3
    done
else
    compare 480x320 20
    compare 1280x720 20
fi
exit $failed
