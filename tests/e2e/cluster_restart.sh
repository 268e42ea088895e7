#!/bin/sh
# cluster_restart.sh - a coordinator that is killed in the middle of a job and
# starts again gets the job and the workers back; the bytes are the same
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
. "$top_srcdir/tests/e2e/cluster.sh"
set -u

view="-vf $scenes/room.vf -x 400 -y 300 -ps 1 -ds .1 -dj 1 -ab 0
--partition=window --windows=40"
room=$scenes/room.rad

coord_options=--log-level=debug
cluster_start 2 1
# shellcheck disable=SC2086 # options are words
"$radsubmit" --coordinator="$sock" $view -o calm.hdr "$room" 2>stderr ||
    fail "calm: $(cat stderr)"
# Worker 2 stands still with a unit, so that the job lasts until the restart.
: >c.log
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=again $view -o again.hdr "$room" \
    2>again.err &
job=$!
until_true 60 grep -q 'unit out .*worker=w2 ' c.log || fail "w2 gets nothing"
kill -STOP "$pid_2"
until_true 60 in_the_middle again || fail "the job does not start"
kill -KILL "$coord_pid"
wait "$coord_pid" 2>/dev/null
"$radcoord" --listen="$tcp" --keys="$work/keys" --socket="$sock" \
    --state="$work/state" 2>>c.log &
coord_pid=$!
kill -CONT "$pid_2"
ended() { gone $job; }
until_true 60 ended || {
    fail "the job does not end: $(tail -n 5 c.log)"
    kill $job
}
wait $job || fail "again: $(cat again.err)"
grep -q 'connected again' again.err || fail "the client saw no restart"
cmp calm.hdr again.hdr || fail "the picture after a restart differs"
grep 'RESULT' c.log && fail "results of the earlier life were not forgotten"
cluster_stop
finish
