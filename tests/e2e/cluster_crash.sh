#!/bin/sh
# cluster_crash.sh - a scene that crashes or loops the renderer fails its own
# job, after two workers, and says where; a worker's own troubles fail nothing
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

radd=$top_builddir/tests/tools/radd-hooked
room=$scenes/room.rad
view="-vf $scenes/room.vf -x 160 -y 120 -ps 1 -ds .1 -dj 1 -ab 0
--partition=window --windows=40"

for kind in crash loop; do
    {
        echo "void plastic test-$kind-70-33 0 0 5 .5 .5 .5 0 0"
        cat "$room"
    } >$kind.rad
done

# shellcheck disable=SC2086 # options are words
submit() # NAME SCENE OPTION...
{
    name=$1 scene=$2
    shift 2
    "$radsubmit" --coordinator="$sock" --name="$name" $view "$@" \
        -o "$name.hdr" "$scene" >/dev/null 2>"$name.err"
}

# fails NAME TEXT...: the job failed as our bug, and its last words have these
fails()
{
    name=$1
    shift
    wait "$job"
    status=$?
    [ $status -eq 70 ] || fail "$name: status $status, expected 70"
    for text in "$@"; do
        grep -q -e "$text" "$name.err" ||
            fail "$name: '$text' is not in: $(cat "$name.err")"
    done
}

# shellcheck disable=SC2086
"$radsubmit" --local --threads=1 $view -o alone.hdr "$room" 2>stderr ||
    fail "embedded: $(cat stderr)"

worker_options='--pixel-s=1 --nice=0'
cluster_start 3 1
submit good "$room" &
good=$!
submit crash crash.rad &
job=$!
fails crash 'unit [0-9]* (frame' 'pixels at x [0-9]*, y [0-9]*' '2 times' \
    'killed by signal 6'
submit loop loop.rad &
job=$!
fails loop 'unit [0-9]* (frame' '2 times' 'pixel at x 70, y 33'
wait $good || fail "the other job: $(cat good.err)"
cmp alone.hdr good.hdr || fail "the other job's picture differs"
for k in 1 2 3; do
    eval "gone \$pid_$k" && fail "worker $k is gone"
done
# a unit whose last rows had not left is suspected, too, and tried again
for why in 'signal 6' 'took more'; do
    n=$(grep "child lost.*$why" c.log | sed 's/.*worker=//; s/ .*//' |
        sort -u | wc -l)
    [ "$n" -ge 2 ] || fail "$why: $n workers tried it, not two"
done

# more memory than the job may have: it fails, alone, and says which limit
submit beside "$room" &
good=$!
submit thrifty "$room" --memory-mib=3
status=$?
[ $status -eq 65 ] || fail "thrifty: status $status, expected 65"
grep -q 'the job may have 3 MiB (--memory-mib)' thrifty.err ||
    fail "no word of the job's limit: $(cat thrifty.err)"
wait $good || fail "beside it: $(cat beside.err)"
cmp alone.hdr beside.hdr || fail "the picture beside it differs"
submit frugal "$room" --memory-mib=500 || fail "frugal: $(cat frugal.err)"

# one that has no memory for it is no reason to give up while others have
submit again "$room" || fail "after that: $(cat again.err)"
worker_options='--memory-mib=3 --nice=0'
worker_start 4 1
until_true 30 n_workers 4 || fail "worker 4 does not come"
submit poor "$room" || fail "beside a poor worker: $(cat poor.err)"
cmp alone.hdr poor.hdr || fail "the picture beside a poor worker differs"
cluster_stop

worker_options='--memory-mib=3 --nice=0'
cluster_start 1 1
submit poorer "$room" --memory-mib=500 && fail "a job without memory is done"
grep -q 'no worker can.*may have 3 MiB here (memory_mib)' poorer.err ||
    fail "no word of radd's limit: $(cat poorer.err)"
cluster_finish
