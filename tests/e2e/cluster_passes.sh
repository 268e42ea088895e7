#!/bin/sh
# cluster_passes.sh - the ambient cache in passes: a coordinator that is killed
# in a pass, between passes or in the picture goes on from there, with the same
# bytes; so does a cluster whose worker is killed, or that a worker joins
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

# so wide that passes come in parts, some of which are open at a time
view="-vf $scenes/room.vf -x 2080 -y 32 -pa 0 -ps 2 -pt .01 -ab 3 -aa .15 -ar 32
-ad 128 -as 32 --ambient=passes"
room=$scenes/room.rad

# shellcheck disable=SC2086 # options are words
"$radsubmit" --local --workers=1 $view --stats=calm.json -o calm.hdr "$room" \
    2>stderr || fail "calm: $(cat stderr)"
body calm.hdr >calm.body

same()
{
    end_job "$1"
    body "$1.hdr" >same.body
    cmp calm.body same.body || fail "$1: another picture"
    [ "$(total "$1.json" tile_values)" = "$(total calm.json tile_values)" ] ||
        fail "$1: $(total "$1.json" tile_values) records of passes"
}

start() # NAME OPTION...
{
    name=$1
    shift
    : >c.log
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" --name="$name" $view "$@" \
        --stats="$name.json" -o "$name.hdr" "$room" 2>"$name.err" &
    job=$!
}

coord_options=--log-level=debug
worker_options=--nice=0 # other tests run beside this one
cluster_start 2 1

# in the first pass, when some are closed, in the last, in the picture
n=0
for at in 'pass=0 ' 'pass=4 ' 'step=8 ' 'unit out'; do
    n=$((n + 1))
    start "again$n"
    until_log "$at"
    job_ended || coord_crash
    same "again$n"
done
grep -q 'passes kept .*passes=[1-9]' c.log ||
    echo "the last job was over before its coordinator was killed"

# many frames are made in batches: killed in the pictures of the first batch, and
# in those of the second
awk 'BEGIN {
    for (k = 0; k < 40; k++)
        printf "rvu -vtv -vp 2 %g 1.3 -vd %g 1 -.12 -vu 0 0 1 -vh 75 -vv 60\n",
            .15 + .01 * k, .005 * k
}' >views
walk="--views=views -S 1 -x 160 -y 120 -ab 2 -aa .3 -ar 16 -ad 128 -as 32"
# shellcheck disable=SC2086
"$radsubmit" --local --workers=1 $walk -o 'calm%d.hdr' "$room" 2>stderr ||
    fail "calm walk: $(cat stderr)"
: >c.log
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=walk $walk -o 'walk%d.hdr' "$room" \
    2>walk.err &
job=$!
there() { [ -s "walk$frame.hdr" ] || job_ended; }
for frame in 1 22; do
    until_true 60 there || fail "frame $frame does not come"
    job_ended || coord_crash
done
end_job walk
for frame in $(seq 40); do
    body "calm$frame.hdr" >calm.body.k
    body "walk$frame.hdr" >same.body
    cmp calm.body.k same.body || fail "another picture of frame $frame"
done

# the only worker of the two that has tiles, and one that comes later
start worker
until_log 'pass=2 '
id=$(sed -n 's/^radsubmit: job //p' worker.err)
"$radctl" --coordinator="$sock" job "$id" >said
grep -Eq '^ambient cache +pass [1-9][0-9]* of [1-9]' said || job_ended ||
    fail "radctl job says nothing of passes: $(cat said)"
# shellcheck disable=SC2154 # worker_start sets them
kill -KILL "$pid_1"
wait "$pid_1" 2>/dev/null
worker_start 1 1
worker_start 3 1
same worker

# a job that passes are closed of, that has no units yet and lost all workers: after
# a restart radsubmit still knows that it was begun; it may be cancelled
start cancelled -t 1
until_log 'pass=2 '
seen() { grep -q 'worker' cancelled.err || job_ended; }
until_true 60 seen || fail "no progress is told: $(cat cancelled.err)"
id=$(sed -n 's/^radsubmit: job //p' cancelled.err)
# shellcheck disable=SC2154
kill -KILL "$pid_1" "$pid_2" "$pid_3"
wait "$pid_1" "$pid_2" "$pid_3" 2>/dev/null
if ! job_ended; then
    coord_crash
    until_true 30 grep -q 'no worker is at the job any more' cancelled.err ||
        fail "nobody says that all workers left: $(cat cancelled.err)"
    grep -q 'has begun yet' cancelled.err && fail "$(cat cancelled.err)"
    until_true 20 "$radctl" --coordinator="$sock" cancel "$id" ||
        fail "a job with passes alone cannot be cancelled"
    "$radctl" --coordinator="$sock" status >said ||
        fail "the coordinator is gone: $(tail -n 3 c.log)"
    until_true 60 job_ended || fail "a cancelled job does not end"
fi
cluster_finish
