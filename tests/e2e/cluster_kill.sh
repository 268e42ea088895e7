#!/bin/sh
# cluster_kill.sh - real daemons give the embedded cluster's bytes, also when a
# worker and a job's child are killed in the middle
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
. "$top_srcdir/tests/e2e/cluster.sh"
set -u

view="-vf $scenes/room.vf -x 400 -y 300 -ps 1 -ds .1 -dj 1 -ab 0
--partition=window --windows=40"
room=$scenes/room.rad

# shellcheck disable=SC2086 # options are words
"$radsubmit" --local --workers=1 --threads=1 $view -o alone.hdr "$room" \
    2>stderr || fail "embedded: $(cat stderr)"

coord_options=--log-level=debug
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
cluster_stop
finish
