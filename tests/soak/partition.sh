#!/bin/sh
# partition.sh - the connections of a worker, and of radsubmit, are held one way
# or both, broken, refused, half open, slow, torn in the middle of a message;
# every picture is the undisturbed one's
#
# The short form inflicts each of the eight shapes once, for half a second.
# RADD_SOAK=long: ten times each, from ten seeds, for 1 to 20 s (15 s without a
# byte end a connection).  PARTITION_SEED, which is printed, PARTITION_ROUNDS.
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/chance.sh"
. "$top_srcdir/tests/e2e/faults.sh"

long=false
[ "${RADD_SOAK:-}" = long ] && long=true
if $long; then
    : "${PARTITION_ROUNDS:=10}"
fi
draw_from "${PARTITION_SEED:-}"

room=$scenes/room.rad
view="-vf $scenes/room.vf -x 160 -y 120 -ps 2 -ds .1 -dj .7 -pj .7 -ab 0"

# shellcheck disable=SC2086 # options are words
"$radsubmit" --local --threads=1 $view -o alone.hdr "$room" 2>stderr ||
    fail "embedded: $(cat stderr)"
# shellcheck disable=SC2086
"$radsubmit" --local --threads=1 $view --partition=window --windows=24 \
    -o window.hdr "$room" 2>stderr || fail "embedded: $(cat stderr)"

# jobs, one after the other, until there is a file called enough
stream()
{
    n=0
    while [ ! -e enough ]; do
        n=$((n + 1))
        case $((n % 3)) in
        0) part='window --windows=24' ref=window.hdr ;;
        1) part=auto ref=alone.hdr ;;
        2) part=scanbar ref=alone.hdr ;;
        esac
        # shellcheck disable=SC2086
        timeout 200 "$radsubmit" --coordinator="$work/user.sock" $view \
            --partition=$part -o stream.hdr "$room" \
            >/dev/null 2>stream.err ||
            echo "job $n ($part): $(cat stream.err)" >>wrong
        cmp -s $ref stream.hdr || echo "job $n ($part): another picture" >>wrong
        rm -f stream.hdr
        echo $n >count
    done
}

coord_options=--lease-floor-s=2
faulty_start 3 1
proxy_start user "$work/user.sock" "$sock"
stream &
jobs=$!
round=0
while [ $round -lt "${PARTITION_ROUNDS:-1}" ]; do
    for shape in $shapes; do
        any 3
        victim=$((any + 1))
        inflict "$shape" $victim
        any 4
        [ $any -eq 0 ] && tell user drop
        any 20
        if $long; then
            sleep $((any + 1))
        else
            sleep .5
        fi
        heal $victim
        [ -e wrong ] && echo "after '$shape' to worker $victim, round $round"
        sleep .3
    done
    round=$((round + 1))
done
touch enough
wait $jobs
[ -e wrong ] && fail "$(cat wrong)"
echo "$(cat count) jobs"
[ "$(cat count)" -ge 2 ] || fail "no jobs were done meanwhile"
grep -q 'connection lost' c.log || fail "no connection was lost"
grep -h 'duplicate differs' c.log && fail "results differ"
grep -h 'protocol error' ./*.log && fail "somebody broke the protocol"
until_true 60 n_workers 3 || fail "not all workers are back"
faulty_stop
finish
