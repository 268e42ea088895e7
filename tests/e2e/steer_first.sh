#!/bin/sh
# steer_first.sh - pause and drain take hold before the first unit,
# too: of ambient records that are made first, and of estimates; the picture and
# its rays are those of one process
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/steer_lib.sh"

# ticks WORKER...: processor time that their children used
ticks()
{
    for worker; do
        for pid in $(child_of "$worker"); do
            cat "/proc/$pid/stat" 2>/dev/null
        done
    done | awk '{ n += $14 + $15 } END { print n + 0 }'
}

# at_work WORKER...: each for a while
at_work()
{
    for worker; do
        [ "$(ticks "$worker")" -gt 20 ] || return 1
    done
}

# used MORE WORKER: since it had used $then
used()
{
    [ "$(ticks "$2")" -gt $((then + $1)) ]
}

# at_rest WORKER...: nothing is used in a time that work would take some of
at_rest()
{
    then=$(ticks "$@")
    sleep .3
    [ "$(ticks "$@")" -le $((then + 1)) ]
}

# No unit of the job went out yet.
before_units()
{
    ! grep -q "unit out job=$id" c.log
}

coord_options=--log-level=debug
cluster_start 2 1

# --- records of parts of space: minutes of them ---

deep='-x 512 -y 384 -ab 3 -ad 4096 -as 0 -aa .02'
# shellcheck disable=SC2086 # options are words
submit paused $deep
until_true 30 at_work 1 2 || fail "nobody makes records"
ctl pause "$id" || fail "pause"
until_true 1 at_rest 1 2 || fail "records of a paused job are made"
ctl cancel "$id" || fail "cancel"
wait "$job"

# shellcheck disable=SC2086 # options are words
submit drained $deep
until_true 30 at_work 1 2 || fail "nobody makes records again"
ctl drain w1 || fail "drain"
until_true 1 at_rest 1 || fail "a drained worker makes records"
ctl undrain w1 || fail "undrain"
ctl cancel "$id" || fail "cancel"
wait "$job"

# --- an estimate of all pixels ---

size='-x 700 -y 525 -ab 0 -ds .02'
# shellcheck disable=SC2086 # options are words
submit estimated $size --estimate=1000a
until_true 30 at_work 1 2 || fail "nobody estimates"
ctl pause "$id" || fail "pause"
until_true 1 at_rest 1 2 || fail "a paused job is estimated"
before_units || fail "the estimate is over: too little to pause it"
ctl resume "$id" || fail "resume"
until_true 30 used 10 2 || fail "the estimate does not go on"
held=$(child_of 2) # it stands still, so that the estimate lasts until all is done
kill -STOP "$held"
ctl drain w1 || fail "drain"
until_true 1 at_rest 1 || fail "a drained worker estimates"
ctl undrain w1 || fail "undrain"
kill -CONT "$held"
end_one "$pid_2" 'worker 2'
before_units || fail "the estimate is over before a worker leaves"
wait "$job" || fail "estimated: $(cat estimated.err)"

# --- the same as in one process ---

# shellcheck disable=SC2086 # options are words
"$radsubmit" --local --threads=2 --stats=alone.json -vf "$scenes/room.vf" \
    -ps 1 -dj 1 $size -o alone.hdr "$scenes/room.rad" 2>alone.err ||
    fail "alone: $(cat alone.err)"
cmp estimated.hdr alone.hdr || fail "another picture"
[ "$(total estimated.json primary_rays)" = \
    "$(total alone.json primary_rays)" ] || fail "other primary rays"
echo "estimated: $(total estimated.json rays) rays," \
    "alone $(total alone.json rays)"
cluster_finish
