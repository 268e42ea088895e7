#!/bin/sh
# versions.sh - a cluster of which one half offers newer versions of the protocol
# besides: a proxy raises what HELLO offers, as if its sender had been upgraded,
# and all that follows is between the daemons
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/faults.sh"

view="-vf $scenes/room.vf -x 240 -y 180 -ps 4 -ab 0"
room=$scenes/room.rad

# comes N: worker 1 has come N times, and speaks version 1
comes()
{
    [ "$(grep -c 'hello .*name=w1 .* protocol=1$' "$work/c.log")" -ge "$1" ]
}

# submit AT OUT OPTION...
submit()
{
    at=$1 out=$2
    shift 2
    # shellcheck disable=SC2086 # options are words
    "$radsubmit" --coordinator="$at" "$@" $view --stats="$out.json" \
        -o "$out" "$room" 2>stderr </dev/null || fail "$out: $(cat stderr)"
}

# shellcheck disable=SC2086
"$radsubmit" --local --workers=1 --threads=1 $view -o strict.hdr "$room" \
    2>stderr || fail "embedded: $(cat stderr)"
# shellcheck disable=SC2086
"$radsubmit" --local --workers=1 --threads=1 --partition=window $view \
    -o window.hdr "$room" 2>stderr || fail "embedded: $(cat stderr)"

faulty_start 2 1
proxy_start new "$work/new.sock" "$sock"
tell new speak 9
tell c1 speak 9
tell c1 drop
until_true 30 comes 2 || fail "worker 1 does not come back"

# both take part, whoever asks, with lines shared between them and without
for part in window scanbar auto; do
    for at in "$sock" "$work/new.sock"; do
        submit "$at" out.hdr --partition=$part
        [ $part = window ] && want=window.hdr || want=strict.hdr
        cmp "$want" out.hdr || fail "$part by $at: another picture"
    done
done
grep -q 'hello .*role=user .* protocol=1$' "$work/c.log" ||
    fail "no radsubmit was heard"
"$radctl" --coordinator="$work/new.sock" key list >/dev/null || fail "keys"

# upgraded in the middle of a job: what it kept goes on
view="-vf $scenes/room.vf -x 400 -y 300 -ps 1 -ds .1 -ab 0
--partition=window --windows=40"
submit "$sock" calm.hdr
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=turn $view -o out.hdr "$room" \
    2>stderr &
job=$!
until_true 60 in_the_middle turn || fail "the job does not start"
tell c1 speak 2
tell c1 drop
until_true 30 comes 3 || fail "worker 1 does not come back"
wait $job || fail "turn: $(cat stderr)"
cmp calm.hdr out.hdr || fail "the picture after an upgrade differs"

grep -H 'protocol error\|not sent' ./*.log && fail "somebody is not understood"
faulty_stop
finish
