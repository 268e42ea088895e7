#!/bin/sh
# cluster_restart.sh - a coordinator that is killed in the middle of a job and
# starts again gets the job and the workers back; the bytes are the same
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

view="-vf $scenes/room.vf -x 400 -y 300 -ps 1 -ds .1 -dj 1 -ab 0
--partition=window --windows=40"
room=$scenes/room.rad

coord_options=--log-level=debug
cluster_start 2 1
# shellcheck disable=SC2086 # options are words
"$radsubmit" --coordinator="$sock" $view -o calm.hdr "$room" 2>stderr ||
    fail "calm: $(cat stderr)"

both_work()
{
    grep -q 'unit out .*worker=w1 ' c.log && grep -q 'unit out .*worker=w2 ' c.log
}

both_work_or_ended()
{
    both_work || job_ended
}

# again NAME: the job once more, as calm.hdr; the coordinator is killed in the
# middle.  One worker stands still with a unit, so that it lasts until then; not
# the one at the top, which the other may have to wait for.
again()
{
    # on a busy machine one may be through before the other has the scene
    for _ in 1 2 3 4 5 6 7 8; do
        : >c.log
        # shellcheck disable=SC2086
        "$radsubmit" --coordinator="$sock" --name="$1" $view \
            --stats="$1.json" -o "$1.hdr" "$room" 2>"$1.err" &
        job=$!
        until_true 60 both_work_or_ended
        top=$(sed -n 's/.*unit out .*worker=w\([12]\) .* y=0 .*/\1/p' c.log |
            head -n 1)
        eval "stopped=\$pid_$((3 - ${top:-1}))"
        kill -STOP "$stopped"
        until_true 60 in_the_middle_or_ended "$1" || fail "the job does not start"
        coord_crash
        kill -CONT "$stopped"
        end_job "$1"
        grep -q 'connected again' "$1.err" && break
    done
    both_work || fail "a worker gets nothing"
    grep -q 'connected again' "$1.err" || fail "the client saw no restart"
    cmp calm.hdr "$1.hdr" || fail "the picture after a restart differs"
}

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
rays=$(total calm.json primary_rays)
[ "$(total lines.json primary_rays)" = "$rays" ] ||
    fail "$(total lines.json primary_rays) primary rays, not $rays"

# who was at a job in an earlier life and does not call again is gone, since now
view="-vf $scenes/room.vf -x 400 -y 300 -ps 1 -ds .1 -dj 1 -ab 0
--partition=window --windows=40"
# paused, it does not end before it is looked at
for n in 1 2 3 4 5; do
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" --name="left$n" $view -o left.hdr "$room" \
        2>stderr &
    job=$!
    until_true 60 in_the_middle_or_ended "left$n" || fail "the job does not start"
    id=$(sed -n 's/^radsubmit: job //p' stderr)
    "$radctl" --coordinator="$sock" pause "$id" && break
    wait $job
done
# shellcheck disable=SC2154 # worker_start sets them
kill -KILL "$coord_pid" $job "$pid_1" "$pid_2"
wait "$coord_pid" $job "$pid_1" "$pid_2" 2>/dev/null
workers=
# shellcheck disable=SC2086
coord_start
"$radctl" --coordinator="$sock" --json workers >gone.json || fail "no answer"
python3 - <<'END' || fail "who is gone: $(cat gone.json)"
import json
w = json.load(open("gone.json"))
assert w and all(x["state"] == "gone" and x["since_s"] < 3600 for x in w), w
END
cluster_finish
