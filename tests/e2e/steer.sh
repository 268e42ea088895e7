#!/bin/sh
# steer.sh - pause, priorities, drain and cancel take hold in the middle of
# units: what is left of these goes back, nothing is lost, and pictures and rays
# are those of one process
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/steer_lib.sh"

# said WORDS JOB [MORE]: how often the log has it
said()
{
    grep -c "$1 job=$2.*${3-}" c.log
}

# more_said NUMBER WORDS JOB [MORE]
more_said()
{
    n=$1
    shift
    [ "$(said "$@")" -gt "$n" ]
}

# No worker has anything in hand.
at_rest()
{
    [ "$(ctl --json workers | grep -c '"units": 0,')" -eq 3 ]
}

# in_hand N: more than so many units went out
in_hand()
{
    more_said "$1" 'unit out' "$id"
}

size="-x 400 -y 300 -ds .05"
coord_options='--log-level=debug --lease-floor-s=600'
cluster_start 3 1

# --- pause ---

# on a busy machine the job may be over before that, or its workers between units
for try in 1 2 3 4 5 6 7 8; do
    paused=paused$try
    # shellcheck disable=SC2086 # options are words
    submit $paused $size
    until_true 30 in_hand 2 || fail "the job does not begin"
    if ctl pause "$id"; then
        until_true 30 at_rest || fail "workers go on with a paused job"
        out=$(said 'unit out' "$id")
        [ "$(said 'unit yield' "$id")" -eq 0 ] || break
        ctl resume "$id" || fail "resume"
    fi
    wait $job
done
[ "$(said 'unit yield' "$id")" -gt 0 ] || fail "no unit went back"
ctl resume "$id" || fail "resume"
until_true 30 in_hand "$out" || fail "the job does not go on"

# --- drain, which a restart does not end ---

ctl drain w1 || fail "drain"
until_true 30 sh -c "'$radctl' --coordinator='$sock' workers |
    grep -q '^w1 *drained'" || fail "w1 is not drained"
coord_crash
until_true 60 sh -c "'$radctl' --coordinator='$sock' workers |
    grep -q '^w1 *drained'" || fail "w1 is not drained after a restart"
grep -q 'worker hangs' c.log && fail "a worker is said to hang"
ctl undrain w1 || fail "undrain"
wait $job || fail "paused: $(cat $paused.err)"
expect 64 'the job is over' 'cancel of a job that is over' \
    "$radctl" --coordinator="$sock" cancel "$id"

# --- priorities ---

# shellcheck disable=SC2086 # options are words
submit low $size --priority=-50
low=$id low_job=$job
until_true 30 more_said 0 'unit out' "$low" worker=w3 || fail "low does not begin"
# A child stands still with a unit: it lasts until all is done to it.
held=$(child_of 3) && kill -STOP "$held" || fail "low has no child"
# a worker may just then be between two units, and be free without giving back
for try in 1 2 3 4 5; do
    submit "high$try" -x 60 -y 50 -ds .2 --priority=50
    wait $job || fail "high: $(cat "high$try.err")"
    gone $low_job && fail "low is over before high"
    [ "$(said 'unit yield' "$low")" -eq 0 ] || break
    [ $try -lt 5 ] || fail "low gave nothing back"
done
submit late -x 60 -y 50 -ds .2 --priority=-100
expect 64 'from -100 to 100' 'a priority out of range' \
    "$radctl" --coordinator="$sock" priority "$id" 101
expect 64 "'high' is no whole number" 'a priority in words' \
    "$radctl" --coordinator="$sock" priority "$id" high
expect 64 'missing N' 'no priority' "$radctl" --coordinator="$sock" \
    priority "$id"
ctl priority "$id" 100 || fail "priority"
wait $job || fail "late: $(cat late.err)"
gone $low_job && fail "low is over before late"
ctl priority "$low" -7 || fail "priority of low"
ctl jobs | grep -q -- ' -7 ' || fail "low has another priority"

# --- a worker that leaves ---

gone $low_job && fail "low is over before a worker leaves"
end_one "$pid_2" 'worker 2'
kill -CONT "$held"
wait $low_job || fail "low: $(cat low.err)"

# --- the same as in one process ---

# shellcheck disable=SC2086 # options are words
"$radsubmit" --local --threads=2 --stats=alone.json -vf "$scenes/room.vf" \
    -ps 1 -dj 1 -ab 0 $size -o alone.hdr "$scenes/room.rad" 2>alone.err ||
    fail "alone: $(cat alone.err)"
for name in $paused low; do
    cmp "$name.hdr" alone.hdr || fail "$name: another picture"
    [ "$(total $name.json primary_rays)" = \
        "$(total alone.json primary_rays)" ] || fail "$name: other primary rays"
    echo "$name: $(total $name.json rays) rays, alone $(total alone.json rays)"
done
# pixels that were under way, at most; a restart has lost more of the first
[ "$(total low.json rays)" -le $(($(total alone.json rays) * 102 / 100)) ] ||
    fail "low: rays were traced again"
cluster_finish
