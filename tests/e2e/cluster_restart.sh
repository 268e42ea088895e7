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

# again NAME: the job once more, as calm.hdr; the coordinator is killed in the
# middle.  Worker 2 stands still with a unit, so that it lasts until then.
again()
{
    : >c.log
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" --name="$1" $view --stats="$1.json" \
        -o "$1.hdr" "$room" 2>"$1.err" &
    job=$!
    until_true 60 grep -q 'unit out .*worker=w2 ' c.log || fail "w2 gets nothing"
    kill -STOP "$pid_2"
    until_true 60 in_the_middle "$1" || fail "the job does not start"
    kill -KILL "$coord_pid"
    wait "$coord_pid" 2>/dev/null
    # shellcheck disable=SC2086
    "$radcoord" --listen="$tcp" --keys="$work/keys" --socket="$sock" \
        --state="$work/state" $coord_options 2>>c.log &
    coord_pid=$!
    kill -CONT "$pid_2"
    until_true 60 ended || {
        fail "the job does not end: $(tail -n 5 c.log)"
        kill $job
    }
    wait $job || fail "$1: $(cat "$1.err")"
    grep -q 'connected again' "$1.err" || fail "the client saw no restart"
    cmp calm.hdr "$1.hdr" || fail "the picture after a restart differs"
}

ended() { gone $job; }
again again
grep 'RESULT' c.log && fail "results of the earlier life were not forgotten"

# lines: the base line under a unit that is kept is on the disk, and no ray is
# traced but once
view="-vf $scenes/room.vf -x 400 -y 300 -ps 4 -ds .1 -dj 1 -ab 0
--partition=scanbar"
# shellcheck disable=SC2086
"$radsubmit" --local --workers=1 $view --stats=calm.json -o calm.hdr "$room" \
    2>stderr || fail "calm lines: $(cat stderr)"
again lines
for f in calm lines; do
    sed -n '/"totals"/,$ s/.*"primary_rays": *\([0-9]*\).*/\1/p' $f.json |
        head -n 1 >$f.rays
done
test -s calm.rays || fail "no rays in the statistics"
cmp calm.rays lines.rays || fail "other primary rays"
cluster_stop
finish
