#!/bin/sh
# submit_detach.sh - a job on a real coordinator: left alone, watched and
# fetched with radctl, cancelled, and waited for across a restart
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

sock=$work/coord.sock
export RADD_COORDINATOR="$sock"
view="-vf $scenes/room.vf -x 120 -y 90 -ab 0 --partition=window --windows=64"
slow="-vf $scenes/room.vf -x 3000 -y 2250 -ps 1 -ds .02 -dj 1"
room=$scenes/room.rad

start_coordinator()
{
    "$radcoord" --listen= --socket="$sock" --state="$work/state" 2>>coord.log &
    coord=$!
    until_true 20 "$radctl" status || fail "no coordinator"
}

start_worker()
{
    "$radd" --coordinator="$sock" --name="$1" --threads=1 \
        --listen=127.0.0.1:0 --cache="$work/cache-$1" 2>>"$1.log" &
}

start_coordinator

# no worker yet: accepted all the same, and not to be had yet
# shellcheck disable=SC2086 # options are words
id=$("$radsubmit" --detach --name=detached $view "$room" 2>stderr) ||
    fail "--detach: $(cat stderr)"
printf '%s\n' "$id" | grep -qE '^[0-9a-f]{32}$' || fail "'$id' is no id"
expect 75 "" "fetch too early" "$radctl" fetch "$id" -o out.hdr
{ cat "$scenes/room.vf" && echo "rvu -vh 40" && echo "rvu -vh 30"; } >three.vf
# shellcheck disable=SC2086
walk=$("$radsubmit" --detach $view -S 1 --views=three.vf "$room" 2>stderr) ||
    fail "--detach -S: $(cat stderr)"
expect 75 "0 of 3 pictures are written: the picture is not complete" \
    "an animation too early" "$radctl" fetch "$walk" -o out%d.hdr
"$radctl" cancel "$walk" || fail "cancel the animation"
"$radctl" jobs >jobs || fail "radctl jobs"
grep -qE "^$id +waiting +0 % .*detached" jobs ||
    fail "radctl jobs does not name the job: $(cat jobs)"

# who waits is told why nothing happens
# shellcheck disable=SC2086
"$radsubmit" $view -o waits.hdr "$room" 2>waits.err &
waits=$!
until_true 30 grep -q "no worker has begun" waits.err ||
    fail "nothing of no worker: $(cat waits.err)"
paused=$(sed -n 's/radsubmit: job //p' waits.err)
"$radctl" pause "$paused" || fail "pause"
until_true 30 grep -q "is paused: radctl resume $paused" waits.err ||
    fail "nothing of the pause: $(cat waits.err)"
"$radctl" resume "$paused" || fail "resume"
until_true 30 grep -q "the job goes on" waits.err ||
    fail "nothing of its end: $(cat waits.err)"
kill -INT $waits
wait $waits
[ $? -eq 75 ] || fail "interrupted while it waits: $(cat waits.err)"

# what ends a session does not end the job
left=
for signal in HUP TERM; do
    : >left.err # what the one before said is not this one's
    # a hang-up may be ignored where the tests run (nohup), and is inherited
    env --default-signal=HUP "$radsubmit" $view -o left.hdr "$room" 2>left.err &
    waits=$!
    until_true 30 grep -q "no worker has begun" left.err ||
        fail "nothing of no worker: $(cat left.err)"
    kill -$signal $waits
    wait $waits
    [ $? -eq 75 ] || fail "SIG$signal: $(cat left.err)"
    left="$left $(sed -n 's/.*the job goes on: radctl fetch \(.*\) -o FILE/\1/p' left.err)"
done

# under nohup a hang-up ends nothing; an interrupt cancels the job then
: >nohup.err
# shellcheck disable=SC2086
(trap "" HUP && exec "$radsubmit" $view -o left.hdr "$room") 2>nohup.err &
waits=$!
until_true 30 grep -q "no worker has begun" nohup.err ||
    fail "nothing of no worker: $(cat nohup.err)"
kill -HUP $waits
kill -INT $waits
wait $waits
[ $? -eq 75 ] || fail "interrupted under nohup: $(cat nohup.err)"
grep -q "cancelled" nohup.err || fail "nohup is unheard: $(cat nohup.err)"

start_worker ws1
until_true 60 "$radctl" fetch "$id" -o out.hdr || fail "never to be fetched"
for other in $left; do
    until_true 60 "$radctl" fetch "$other" -o left.hdr || fail "$other is lost"
    cmp out.hdr left.hdr || fail "the picture of one that was left differs"
done
# shellcheck disable=SC2086
[ "$(printf '%s\n' $left | wc -l)" -eq 2 ] || fail "jobs that go on: '$left'"
# the beginning of an id will do
"$radctl" fetch "$(printf '%.8s' "$id")" >again.hdr || fail "fetch by prefix"
"$radctl" fetch "$id" -o - >dash.hdr || fail "fetch to standard output"
cmp out.hdr dash.hdr || fail "what is fetched to standard output differs"
cmp out.hdr again.hdr || fail "two fetches differ"
"$radsubmit" --local $view -o local.hdr "$room" 2>stderr ||
    fail "local: $(cat stderr)"
cmp out.hdr local.hdr || fail "the daemons' picture is not the embedded one"

# a picture that cannot be written is still to be had
# shellcheck disable=SC2086
expect 74 "/dev/full" "no room for the picture" \
    "$radsubmit" $view -o /dev/full "$room"
kept=$(sed -n 's/.*the coordinator keeps the picture: \(radctl fetch .*\) -o FILE/\1/p' stderr)
[ -n "$kept" ] || fail "not said where it is: $(cat stderr)"
# shellcheck disable=SC2086
"$radctl" ${kept#radctl } -o kept.hdr || fail "'$kept' does not fetch it"
cmp out.hdr kept.hdr || fail "what was kept is another picture"

# and if its cluster ends with radsubmit
# shellcheck disable=SC2086
expect 74 "/dev/full" "no room for the picture of a cluster of its own" \
    "$radsubmit" --local $view -o /dev/full -z depth.zbf "$room"
# shellcheck disable=SC2086
"$radsubmit" --local $view -o again.hdr -z again.zbf "$room" 2>again.err ||
    fail "again: $(cat again.err)"
kept=$(sed -n 's/.*the picture is in //p' stderr)
cmp again.hdr "$kept" || fail "not there: $(cat stderr)"
kept=$(sed -n 's/.*its distances are in //p' stderr)
cmp again.zbf "$kept" || fail "its distances are others: $(cat stderr)"

# so is an animation, whose frames have the numbers that -S gives
# shellcheck disable=SC2086
id=$("$radsubmit" --detach $view -S 7 --views=three.vf "$room" 2>stderr) ||
    fail "--detach -S: $(cat stderr)"
until_true 60 "$radctl" fetch "$id" --frame=9 -o frame%02d.hdr ||
    fail "the third frame is never to be fetched"
mv frame09.hdr third.hdr || fail "its name is not that of the frame: $(ls)"
"$radctl" fetch "$id" --frame=7 -o seventh.hdr &&
    "$radctl" fetch "$id" -o first.hdr && cmp first.hdr seventh.hdr ||
    fail "the first frame"
"$radctl" fetch "$id" --frame=8 -o second.hdr || fail "the second frame"
cmp -s first.hdr second.hdr && fail "two frames of two views are one"
png=$("$radsubmit" --detach --format=png $view "$room" 2>stderr) ||
    fail "--detach --format=png: $(cat stderr)"
"$radctl" job "$png" | grep -q '2 x 2 samples' ||
    fail "--detach --format=png: $("$radctl" job "$png")"
"$radctl" cancel "$png" 2>stderr || "$radctl" delete "$png" 2>stderr
for n in 0 6 10 2147483647; do
    expect 64 "no such frame" "frame $n" "$radctl" fetch "$id" --frame=$n
done
mkdir dir07 dir08 dir09
"$radctl" fetch "$id" -o dir%02d/a%%%d.hdr 2>/dev/null && fail "two numbers"
"$radctl" fetch "$id" -o dir%02d/all.hdr || fail "all frames"
cmp first.hdr dir07/all.hdr && cmp second.hdr dir08/all.hdr &&
    cmp third.hdr dir09/all.hdr || fail "of all frames these are others"
# numbers are those of radsubmit's own files, also where some are left out
# shellcheck disable=SC2086
"$radsubmit" $view -S 7 --views=three.vf --no-clobber -o dir%02d/all.hdr \
    "$room" 2>stderr || fail "--no-clobber: $(cat stderr)"
grep -q "nothing is rendered" stderr || fail "the names are radsubmit's, too"
rm dir07/all.hdr dir09/all.hdr
# shellcheck disable=SC2086
"$radsubmit" $view -S 7 --views=three.vf --no-clobber -o dir%02d/all.hdr \
    "$room" 2>stderr || fail "--no-clobber: $(cat stderr)"
gaps=$(sed -n 's/^radsubmit: job //p' stderr)
"$radctl" fetch "$gaps" --frame=9 -o gap%d.hdr && cmp third.hdr gap9.hdr ||
    fail "the frame behind a gap"
expect 64 "no such frame" "a gap" "$radctl" fetch "$gaps" --frame=8
"$radctl" fetch "$id" -o "50%.hdr" && cmp first.hdr "50%.hdr" ||
    fail "a name with a %"

# what people and programs see
"$radctl" workers | grep -q ws1 || fail "radctl workers does not name ws1"
for q in status workers jobs top "job $id"; do
    # shellcheck disable=SC2086
    "$radctl" --json $q | python3 -c 'import json, sys; json.load(sys.stdin)' ||
        fail "radctl --json $q: no JSON"
done
"$radctl" --json top </dev/null | python3 -c '
import json, sys
top = json.load(sys.stdin)
sys.exit(top["workers"][0]["name"] != "ws1" or "jobs" not in top
         or not top["status"]["program"].startswith("radcoord"))' ||
    fail "radctl --json top: $("$radctl" --json top)"
expect 66 "" "a job that is not there" \
    "$radctl" job 00000000000000000000000000000000

# an empty word would be how every identifier begins
expect 64 "empty ID" "an empty identifier" "$radctl" cancel ""

# a drained worker gets no job; a cancelled job is not to be had
"$radctl" drain ws1 || fail "drain"
id=$("$radsubmit" --detach $view "$room" 2>stderr) || fail "second job"
"$radctl" cancel "$id" || fail "cancel"
expect 66 "cancelled" "fetch of a cancelled job" "$radctl" fetch "$id" -o no.hdr
expect 64 "the job is over" "pause of a job that is over" "$radctl" pause "$id"
expect 64 "the job is over" "resume of one" "$radctl" resume "$id"
expect 66 "'ws9'" "a worker that is not there" "$radctl" drain ws9
"$radctl" undrain ws1 || fail "undrain"

# a cancelled job's radsubmit says so
"$radsubmit" $slow --progress=always -o slow.hdr "$room" 2>slow.err &
pid=$!
until_true 60 grep -q '1 worker' slow.err || fail "the slow job does not start"
"$radctl" cancel "$(sed -n 's/radsubmit: job //p' slow.err)" || fail "cancel"
wait $pid && fail "a cancelled job ended well"
grep -qi cancel slow.err || fail "not said: $(cat slow.err)"

# the coordinator dies while radsubmit waits; both ends find it again
"$radctl" drain ws1
"$radsubmit" $view -o restart.hdr "$room" 2>restart.err &
pid=$!
job=$(until_true 20 grep -q 'radsubmit: job' restart.err &&
    sed -n 's/radsubmit: job //p' restart.err)
until_true 20 "$radctl" job "$job" || fail "the job does not arrive"
kill -9 $coord
wait $coord 2>/dev/null
start_coordinator
until_true 20 "$radctl" undrain ws1 || fail "it forgot a drained worker"
wait $pid || fail "after a restart: $(cat restart.err)"
grep -q 'connected again' restart.err || fail "no word of the restart"
cmp restart.hdr local.hdr || fail "the picture after a restart differs"
finish
