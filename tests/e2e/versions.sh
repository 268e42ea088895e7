#!/bin/sh
# versions.sh - a cluster of which one half speaks the protocol's version 1: a
# proxy lowers what HELLO offers, as if its sender had not been upgraded, and all
# that follows is between the daemons
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
. "$top_srcdir/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/faults.sh"
set -u

view="-vf $scenes/room.vf -x 240 -y 180 -ps 4 -ab 0"
room=$scenes/room.rad

# spoken WHAT VERSION: the coordinator heard such a HELLO
spoken()
{
    grep -q "hello .*$1.* protocol=$2\$" "$work/c.log"
}

# speaks N: worker 1 comes back and speaks that
speaks()
{
    tell c1 speak "$1"
    tell c1 drop
    until_true 30 last_of_1 "$1" || fail "worker 1 does not speak version $1"
}

last_of_1()
{
    grep 'hello .*name=w1 ' "$work/c.log" | tail -n 1 | grep -q "protocol=$1\$"
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

# unnamed PICTURE: without the scene's name, which version 1 cannot tell
unnamed()
{
    LC_ALL=C sed '1,/^$/{/^SCENE= /d}' "$1"
}

# shellcheck disable=SC2086
"$radsubmit" --local --workers=1 --threads=1 $view -o strict.hdr "$room" \
    2>stderr || fail "embedded: $(cat stderr)"
# shellcheck disable=SC2086
"$radsubmit" --local --workers=1 --threads=1 --partition=window $view \
    -o window.hdr "$room" 2>stderr || fail "embedded: $(cat stderr)"

faulty_start 2 1
proxy_start old "$work/old.sock" "$sock"
tell old speak 1
speaks 1
spoken name=w2 2 || fail "worker 2 does not speak version 2"

# both take part, whoever asks, with lines shared between them and without
for part in window scanbar auto; do
    for at in "$sock" "$work/old.sock"; do
        submit "$at" out.hdr --partition=$part
        [ $part = window ] && want=window.hdr || want=strict.hdr
        unnamed "$want" >want.bytes
        unnamed out.hdr >out.bytes
        cmp want.bytes out.bytes || fail "$part by $at: another picture"
    done
done
spoken role=user 1 || fail "no radsubmit spoke version 1"
spoken role=user 2 || fail "no radsubmit spoke version 2"

# several samples a pixel are the coordinator's business alone: floats that come
# from a worker of version 1 are coded there as others' are
view2="-vf $scenes/room.vf -x 80 -y 60 -ps 4 -ab 0 --oversample=2"
# shellcheck disable=SC2086
"$radsubmit" --local --workers=1 $view2 -o one.hdr "$room" 2>stderr ||
    fail "embedded: $(cat stderr)"
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" $view2 -o two.hdr "$room" 2>stderr ||
    fail "several samples: $(cat stderr)"
cmp one.hdr two.hdr || fail "several samples: another picture"
# shellcheck disable=SC2086
expect 76 "too old for --oversample: it speaks protocol version 1" "samples" \
    "$radsubmit" --coordinator="$work/old.sock" $view2 -o x.hdr "$room"

# what version 1 has no word for
"$radctl" --coordinator="$work/old.sock" workers >/dev/null || fail "workers"
expect 76 "too old to be asked that: it speaks protocol version 1" "keys" \
    "$radctl" --coordinator="$work/old.sock" key list
"$radctl" --coordinator="$sock" key list >/dev/null || fail "keys"

# frames in the message, both from it and to it, but for more than it holds
for i in 1 2 3; do
    echo "rview -vp 2 1.$i 1.3 -vd 0 1 0"
done >three.vf
for at in "$sock" "$work/old.sock"; do
    "$radsubmit" --coordinator="$at" -S 1 --views=three.vf -x 60 -y 45 \
        -o "f%d.hdr" "$room" 2>stderr || fail "by $at: $(cat stderr)"
    for i in 1 2 3; do
        unnamed f$i.hdr
    done >three."$([ "$at" = "$sock" ] && echo new || echo old)"
done
cmp three.old three.new || fail "other frames by version 1"
awk 'BEGIN { for (i = 0; i < 20000; i++) print "rview -vp 2 1 1 -vd 0 1 0" }' \
    >many.vf
expect 76 "too old for an animation of 20000 frames" "many frames" \
    "$radsubmit" --coordinator="$work/old.sock" -S 1 --views=many.vf -x 4 \
    -y 3 -o "f%d.hdr" "$room"

# shellcheck disable=SC2086
expect 76 "too old for -af: it speaks protocol version 1" "records" \
    "$radsubmit" --coordinator="$work/old.sock" $view -ab 1 -af r.amb -o x.hdr \
    "$room"

# upgraded in the middle of a job, and taken back: what it kept packed goes on
view="-vf $scenes/room.vf -x 400 -y 300 -ps 1 -ds .1 -ab 0
--partition=window --windows=40"
submit "$sock" calm.hdr
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=turn $view -o out.hdr "$room" \
    2>stderr &
job=$!
until_true 60 in_the_middle turn || fail "the job does not start"
speaks 2
speaks 1
wait $job || fail "turn: $(cat stderr)"
cmp calm.hdr out.hdr || fail "the picture after an upgrade differs"

# taken back in the middle of a job that began after the upgrade: its rows are
# coded, which version 1 does not know
speaks 2
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=back $view -o back.hdr "$room" \
    2>stderr &
job=$!
until_true 60 in_the_middle back || fail "the job does not start"
speaks 1
wait $job || fail "back: $(cat stderr)"
cmp calm.hdr back.hdr || fail "the picture after a way back differs"

grep -H 'protocol error\|not sent' ./*.log && fail "somebody is not understood"
faulty_stop
finish
