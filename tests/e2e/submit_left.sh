#!/bin/sh
# submit_left.sh - the time left is said once it is known, early, and a trial
# that is at work for it holds up no end
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

# Half a minute at least; the first tenth of the picture takes long.
slow="--local --threads=1 -vf $scenes/room.vf -x 900 -y 675 -ab 2 -aa .1
-ar 128 -ad 1024 -as 256 -ps 2 --oversample=1"

ended() # NAME STATUS
{
    kill -INT $pid
    wait $pid
    status=$?
    [ $status -eq "$2" ] || fail "$1: exit status $status: $(cat $1.err)"
    check_nothing_left "$1"
}

start() # NAME OPTIONS...
{
    name=$1
    shift
    # shellcheck disable=SC2086 # options are words
    interruptible "$radsubmit" $slow "$@" -o "$name.hdr" "$scenes/room.rad" \
        2>"$name.err" &
    pid=$!
}

start said --progress=always
until_true 60 grep -q ' left ' said.err || fail "no time left: $(cat said.err)"
grep ' left ' said.err | grep -qv '  [0-9][0-9:]*:[0-9][0-9] left  1 worker$' &&
    fail "another form: $(cat said.err)"
grep -q '?' said.err && fail "a question: $(cat said.err)"
sed -n 's/^ *\([0-9]*\) %.*/\1/p' said.err | head -n 1 | grep -qx '[0-2]' ||
    fail "it began late: $(cat said.err)"
grep ' %' said.err | head -n 1 | grep -q left &&
    fail "said before anything is known: $(cat said.err)"
grep ' left ' said.err | head -n 1 | grep -q '^ *[12]\{0,1\}[0-9] %' ||
    fail "said late: $(cat said.err)"
ended said 75

# Without ambient records there are no passes, whose share tells enough: a trial
# tells the time left, long before a tenth of the picture is there.
start uncached -aa 0 -ad 128 -as 32 --progress=always
until_true 60 grep -q ' left ' uncached.err ||
    fail "no time left without records: $(cat uncached.err)"
grep ' left ' uncached.err | head -n 1 | grep -q '^ *[0-9] %' ||
    fail "said late without records: $(cat uncached.err)"
ended uncached 75

# interrupted while the trial is at work, mostly
start early --ambient=live --progress=always
until_true 60 grep -q '^ *[0-2] %' early.err || fail "no progress: $(cat early.err)"
sleep 2.5
ended early 75

# nobody looks: nothing is said, of a picture of which else even the time left is
for progress in always never; do
    # shellcheck disable=SC2086 # options are words
    "$radsubmit" $slow -x 60 -y 45 -ad 256 -as 64 --progress=$progress \
        -o $progress.hdr "$scenes/room.rad" 2>$progress.err ||
        fail "$progress: $(cat $progress.err)"
done
grep -q '^ *[0-9][0-9]* %' always.err || fail "it says nothing: $(cat always.err)"
grep -q '^ *[0-9][0-9]* %' never.err && fail "it talks: $(cat never.err)"
finish
