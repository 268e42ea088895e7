#!/bin/sh
# cluster_kill.sh - real daemons give the embedded cluster's bytes, also when a
# worker and a job's child are killed in the middle
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

view="-vf $scenes/room.vf -x 400 -y 300 -ps 1 -ds .1 -dj 1 -ab 0
--partition=window --windows=40"
room=$scenes/room.rad

# shellcheck disable=SC2086 # options are words
"$radsubmit" --local --workers=1 --threads=1 $view -o alone.hdr "$room" \
    2>stderr || fail "embedded: $(cat stderr)"

coord_options=--log-level=debug
worker_options=--nice=0 # other tests run beside this one
cluster_start 3 1
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" $view --stats=calm.json -o calm.hdr \
    "$room" 2>stderr || fail "calm: $(cat stderr)"
cmp alone.hdr calm.hdr || fail "three daemons' picture differs"
[ "$(total calm.json units_redone)" -eq 0 ] || fail "units done twice in calm"

# Worker 3 stands still with a unit, so that the job lasts until all is done to it.
: >c.log
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=storm $view --stats=storm.json \
    -o storm.hdr "$room" 2>storm.err &
job=$!
until_true 60 grep -q 'unit out .*worker=w3 ' c.log || fail "w3 gets nothing"
kill -STOP "$pid_3"
until_true 60 in_the_middle storm || fail "the job does not start"
until_true 30 child_of 2 || fail "worker 2 has no child"
child_of 2 | xargs kill -KILL
kill -KILL "$pid_3"
wait $job || fail "storm: $(cat storm.err)"
cmp alone.hdr storm.hdr || fail "the picture after losses differs"
[ "$(total storm.json units_redone)" -gt 0 ] || fail "no unit was done again"
gone "$pid_2" && fail "worker 2 did not survive its child"

# the worker that was killed left no child behind
until_true 10 no_child 3 ||
    fail "the killed worker's child lives on"
# and may come back
worker_start 3 1
until_true 30 n_workers 3 || fail "worker 3 does not come back"

left_runs()
{
    said_of jobs left state | grep -qx running
}

begun_or_ended()
{
    grep -q 'unit out ' c.log || gone $job
}

# a picture of some seconds, and of a fourth of the pixels where a sanitizer takes
# as long for them
wide="-x 1200 -y 900"
is_sanitized &&
    wide="-x 600 -y 450"

# all are gone: radsubmit says that nothing happens, and what may be done; and
# that one is back, which has seconds to do by itself, of which reports tell
for _ in 1 2 3 4 5 6 7 8; do # on a busy machine they may be through too soon
    : >c.log
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" --name=left --same-bits $view \
        $wide -o left.hdr "$room" 2>left.err &
    job=$!
    until_true 60 begun_or_ended
    kill -STOP "$pid_1" "$pid_2" "$pid_3"
    sleep .2 # what is under way has come
    left_runs && break
    kill -CONT "$pid_1" "$pid_2" "$pid_3"
    wait $job
done
kill -KILL "$pid_1" "$pid_2" "$pid_3"
until_true 30 grep -q 'no worker is at the job any more' left.err ||
    fail "nobody says that all workers left"
grep -q 'same-bits takes none but' left.err || fail "nor why that may be"
wait "$pid_1" "$pid_2" "$pid_3"
worker_start 1 1
until_true 60 grep -q 'a worker is at the job again' left.err ||
    fail "nor that one came"
worker_start 2 1
worker_start 3 1
wait $job || fail "left: $(cat left.err)"
# shellcheck disable=SC2086
"$radsubmit" --local $view $wide -o wide.hdr "$room" 2>stderr ||
    fail "wide: $(cat stderr)"
cmp wide.hdr left.hdr || fail "the picture after all left differs"
cluster_finish
