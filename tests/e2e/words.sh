#!/bin/sh
# words.sh - what radsubmit and radctl print for people: nothing that means
# something to programs alone, and a reason where nothing happens
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

view="-vf $scenes/room.vf -x 40 -y 30"
room=$scenes/room.rad

ctl()
{
    "$radctl" --coordinator="$sock" "$@"
}

# --- an id is one of a job that is there ---

# shellcheck disable=SC2086 # options are words
expect 69 "no coordinator" "nobody listens" "$radsubmit" \
    --coordinator="$work/none.sock" --wait=.1 $view -o a.hdr "$room"
grep -q 'radsubmit: job ' stderr && fail "a job that is nowhere has an id"
echo 'void broken' >bad.rad
# shellcheck disable=SC2086
"$radsubmit" --local $view -o a.hdr bad.rad 2>stderr
grep -q 'radsubmit: job ' stderr && fail "a scene that is wrong has a job"

# the last line of progress has no workers, and no time left
# shellcheck disable=SC2086
"$radsubmit" --local --threads=1 --progress=always $view -o a.hdr "$room" \
    2>stderr || fail "$(cat stderr)"
grep '^100 %' stderr | grep -qE 'worker|left' && fail "the end: $(cat stderr)"
[ "$(grep -c '^radsubmit: job ' stderr)" -eq 1 ] || fail "ids: $(cat stderr)"

# --- the coordinator in short ---

coord_start
ctl status >status || fail "status"
grep -qE '^since +20[0-9-]+ [0-9:]+, .* ago$' status || fail "$(cat status)"
grep -qE '^workers +none$' status || fail "$(cat status)"
grep -qE 'epoch|slow_turns|longest' status && fail "riddles: $(cat status)"
ctl --json status | grep -q '"epoch"' || fail "--json has no epoch"
[ "$(ctl jobs)" = "no jobs" ] || fail "no jobs: $(ctl jobs)"
[ "$(ctl workers)" = "no workers" ] || fail "no workers: $(ctl workers)"

# --- why nothing happens ---

# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" $view -o waits.hdr "$room" 2>waits.err &
waits=$!
until_true 30 grep -q 'the coordinator says: no worker is there' waits.err ||
    fail "nothing of no worker: $(cat waits.err)"
id=$(sed -n 's/^radsubmit: job //p' waits.err)
ctl job "$id" >job || fail "job"
grep -qE '^note +no worker is there$' job || fail "job: $(cat job)"
grep -qE '^picture +40 x 30$' job || fail "job: $(cat job)"
grep -qE 'status|units|elapsed_s' job && fail "riddles: $(cat job)"
ctl --json job "$id" | grep -q '"elapsed_s"' || fail "--json has other names"
ctl pause "$id" || fail "pause"
until_true 30 grep -q 'is paused' waits.err || fail "nothing of the pause"
kill -TERM $waits
wait $waits
grep -q "the job stays, paused: radctl resume $id, then radctl fetch $id" \
    waits.err || fail "of a paused job that stays: $(cat waits.err)"

worker_start 1 1
until_true 30 n_workers 1 || fail "no worker"
ctl drain w1 || fail "drain"
ctl resume "$id" || fail "resume"
until_true 30 sh -c "'$radctl' --coordinator='$sock' jobs |
    grep -q '^$id .*all workers are drained'" || fail "$(ctl jobs)"
ctl workers | grep -qE '^w1 +drained .* ago ' || fail "$(ctl workers)"
ctl cancel "$id" || fail "cancel"
ctl jobs | grep -qE "^$id +cancelled .* -$" || fail "$(ctl jobs)"

# workers are at another job: --wait, which is for those that are not there, does
# not run out
ctl undrain w1 || fail "undrain"
first=$("$radsubmit" --coordinator="$sock" --detach -vf "$scenes/room.vf" \
    -x 1000 -y 1000 -ab 4 -ad 4096 -aa .03 "$room" 2>stderr) ||
    fail "$(cat stderr)"
until_true 30 sh -c "'$radctl' --coordinator='$sock' workers |
    grep -q '^w1 *working'" || fail "$(ctl workers)"
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --wait=.5 $view -o queued.hdr "$room" \
    2>queued.err &
queued=$!
until_true 30 grep -q 'no worker has begun yet' queued.err ||
    fail "it did not wait in the queue: $(cat queued.err)"
ctl cancel "$first" >/dev/null || fail "cancel"
wait $queued || fail "from the queue: $(cat queued.err)"
ctl drain w1 || fail "drain"

# an interrupt before any worker came
# shellcheck disable=SC2086
interruptible "$radsubmit" --coordinator="$sock" $view \
    -o none.hdr "$room" 2>none.err &
none=$!
until_true 30 grep -q '^radsubmit: job ' none.err || fail "no id"
kill -INT $none
wait $none
[ $? -eq 75 ] || fail "interrupted: $(cat none.err)"
grep -q 'cancelled: nothing was rendered yet' none.err ||
    fail "what it got: $(cat none.err)"
cluster_finish
