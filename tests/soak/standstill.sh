#!/bin/sh
# standstill.sh - workers and children stand still for twice the lease and go on:
# others take what they had, every picture is the undisturbed one's, and no rows
# that came twice differ
#
# The short form stops one child and one worker; RADD_SOAK=long 50 of them.
# STANDSTILL_TIMES changes that, STANDSTILL_SEED, which is printed, the order.
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

[ "${RADD_SOAK:-}" = long ] && : "${STANDSTILL_TIMES:=50}"
seed=${STANDSTILL_SEED:-$(date +%s)}
echo "seed $seed"

room=$scenes/room.rad
view="-vf $scenes/room.vf -x 400 -y 300 -ps 1 -ds .1 -dj 1 -ab 0"

# shellcheck disable=SC2086 # options are words
"$radsubmit" --local --threads=1 $view -o auto.hdr "$room" 2>stderr ||
    fail "embedded: $(cat stderr)"
# shellcheck disable=SC2086
"$radsubmit" --local --threads=1 $view --partition=window --windows=24 \
    -o window.hdr "$room" 2>stderr || fail "embedded: $(cat stderr)"

coord_options='--lease-floor-s=2 --log-level=debug'
cluster_start 3 1

busy() # K: it has a unit
{
    grep -q "unit out.*worker=w$1 " c.log && child_of "$1"
}

busy_or_over()
{
    busy "$1" || grep -q 'job over' c.log
}

n=0 late=0 quick=0
while [ $n -lt "${STANDSTILL_TIMES:-2}" ]; do
    if [ $(((seed + n) % 2)) -eq 0 ]; then
        part=window how='window --windows=24'
    else
        part=auto how=auto
    fi
    k=$(((seed / 2 + n) % 3 + 1))
    : >c.log
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" --name=job$n $view --partition=$how \
        -o job.hdr "$room" >/dev/null 2>job.err &
    job=$!
    until_true 30 busy_or_over $k || fail "worker $k gets nothing"
    if ! busy $k >/dev/null; then # a quick machine: again
        wait $job || fail "job $n: $(cat job.err)"
        [ $((quick += 1)) -lt 50 ] || fail "each job is over at once"
        continue
    fi
    if [ $((n % 4 / 2)) -eq 0 ]; then
        victims=$(child_of $k)
    else
        eval "victims=\"\$pid_$k \$(child_of $k)\""
    fi
    # shellcheck disable=SC2086 # numbers
    kill -STOP $victims
    sleep 4
    # shellcheck disable=SC2086
    kill -CONT $victims 2>/dev/null
    wait $job || fail "job $n ($part, worker $k): $(cat job.err)"
    cmp $part.hdr job.hdr || fail "job $n ($part): another picture"
    grep 'duplicate differs' c.log && fail "results differ"
    late=$((late + $(grep -c 'unit late' c.log)))
    n=$((n + 1))
done
echo "$late late units went to others"
[ $n -lt 10 ] || [ $late -gt 0 ] || fail "no unit was ever late"
cluster_finish
