#!/bin/sh
# submit_limits.sh - what is long is taken, and what is too long is refused
# before anything is dialled
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

view="-vf $scenes/room.vf -x 24 -y 18 -ab 0"
room=$scenes/room.rad
unset RADD_COORDINATOR

# repeat N TEXT
repeat()
{
    awk -v n="$1" -v s="$2" 'BEGIN { while (n-- > 0) printf "%s", s }'
}

cluster_start 1 1
export RADD_COORDINATOR="$sock"

# --- names ---

# a scene far down, and with no name of its own
deep=$(repeat 8 "$(repeat 100 d)/")
mkdir -p "$deep" && cp "$room" "$deep/room.rad"
# shellcheck disable=SC2086 # options are words
id=$("$radsubmit" --detach $view "$deep/room.rad" 2>stderr) ||
    fail "a path of 800 bytes: $(cat stderr)"
"$radctl" --json job "$id" | grep -q "\"name\": \"$deep/room.rad\"" ||
    fail "the job's name is not its path: $("$radctl" --json job "$id")"
# what is wrong in it is told, with the line
printf 'wood sphere s 0 0 4 0 0 0 1\n' >"$deep/bad.rad"
# shellcheck disable=SC2086
expect 65 "bad.rad:1: undefined modifier 'wood'" "a bad scene far down" \
    "$radsubmit" --local $view "$deep/bad.rad"
# shellcheck disable=SC2086
expect 66 "none.rad': No such file" "no scene far down" \
    "$radsubmit" --local $view "$deep/none.rad"

# 101 bytes of a name, in 51 columns
name=x$(repeat 50 ä)
# shellcheck disable=SC2086
id=$("$radsubmit" --detach --name="$name" $view "$room" 2>stderr) ||
    fail "a name of 101 bytes: $(cat stderr)"
"$radctl" --json job "$id" | grep -q "\"name\": \"$name\"" ||
    fail "another name: $("$radctl" --json job "$id")"
"$radctl" jobs >jobs || fail "radctl jobs: $?"
grep -q " x$(repeat 50 ä)  " jobs || fail "the list has another name: $(cat jobs)"
grep -q " d\{57\}\.\.\.  " jobs || fail "the list does not cut: $(cat jobs)"

# a scene that is a command of more than 4096 bytes, whose 4096th ends a
# character or not
for word in '' x; do
    # shellcheck disable=SC2086
    id=$("$radsubmit" --detach $view "!cat '$room' #$word$(repeat 2100 ä)" \
        2>stderr) || fail "a long command: $(cat stderr)"
    "$radctl" --json job "$id" | grep -q "\"name\": \"!cat .*ä\"" ||
        fail "a long command as a name: $("$radctl" --json job "$id")"
done

# where nobody listens it says 69: what is refused is refused before
# shellcheck disable=SC2086
expect 64 "option '--name': 4097 bytes, and at most 4096" "a name of 4097" \
    "$radsubmit" --coordinator=127.0.0.1:9 --wait=0 \
    --name="$(repeat 4097 n)" $view -o out.hdr "$room"

# shellcheck disable=SC2086
expect 64 "'--windows': all frames together have 100001" "too many windows" \
    "$radsubmit" --coordinator=127.0.0.1:9 --wait=0 $view -x 1000 -y 750 \
    --windows=100001 -o out.hdr "$room"
printf 'VIEW= -vs 0\nVIEW= -vs .1\n' >two.vf
# shellcheck disable=SC2086
expect 64 "all frames together have 120000" "too many windows of two frames" \
    "$radsubmit" --coordinator=127.0.0.1:9 --wait=0 $view -x 1000 -y 750 \
    --windows=60000 -S 1 --views=two.vf -o %d.hdr "$room"
# shellcheck disable=SC2086
expect 69 "" "more windows than pixels" \
    "$radsubmit" --coordinator=127.0.0.1:9 --wait=0 $view --windows=100001 \
    -o out.hdr "$room"

expect 64 "is no job's id" "an id of 33 digits" \
    "$radctl" --coordinator=127.0.0.1:9 job "$(repeat 33 a)"
expect 64 "is no worker's name: at most 64 bytes" "a worker of 65 bytes" \
    "$radctl" --coordinator=127.0.0.1:9 drain "$(repeat 65 w)"

# --- views ---

# 8000 frames, whose long views alone are more than a message holds, are taken,
# go to the workers, and outlive the coordinator
awk 'BEGIN {
    for (i = 0; i < 8000; i++)
        printf "rview -vtv -vp %.12f 1.3333333333333333 1.2222222222222222 " \
            "-vd 0.1234567890123456 0.9876543210987654 -0.0111111111111111 " \
            "-vu 0.0123456789012345 0.0123456789012345 0.9999999999999999 " \
            "-vh 45.123456789 -vv 36.123456789 -vs 0.0001 -vl 0.0001\n", \
            2 + i / 8000
}' >long.vf
[ "$(wc -c <long.vf)" -gt 1700000 ] || fail "the views are short"
# shellcheck disable=SC2086
id=$("$radsubmit" --detach -S 1 --views=long.vf -x 4 -y 3 -ab 0 "$room" \
    2>stderr) || fail "8000 frames: $(cat stderr)"
"$radctl" --json job "$id" | grep -q '"frames": 8000' ||
    fail "not 8000 frames: $("$radctl" --json job "$id")"
frames_ready()
{
    "$radctl" --json job "$id" | sed -n 's/.*"frames_ready": \([0-9]*\).*/\1/p'
}
# more_than N: frames are ready
more_than()
{
    ready=$(frames_ready)
    [ "$ready" -gt "$1" ] || [ "$ready" -eq 8000 ]
}
until_true 60 more_than 0 || fail "no frame of 8000: $(cat w1.log)"
kill -9 "$coord_pid"
wait "$coord_pid" 2>/dev/null
"$radctl" check "$work/state" >check.out 2>&1 || fail "check: $(cat check.out)"
coord_start
worker_start 2 1 # the coordinator has another address
until_true 60 more_than "$(frames_ready)" || fail "the job did not come back: $(cat c.log)"
# it may be done by now; and its answer waits for the disk, behind many pictures
over()
{
    "$radctl" cancel "$id"
    "$radctl" jobs | grep -qE "^$id +(cancelled|done)"
}
until_true 60 over || fail "cancel: $("$radctl" jobs)"

# what comes of a list that travels as a file is what one by one gives, where
# no random numbers are drawn by the frame's
head -n 3 long.vf >three.vf
# shellcheck disable=SC2086
"$radsubmit" -S 1 --views=three.vf -x 40 -y 30 -pj 0 -dj 0 -o all%d.hdr "$room" \
    2>stderr || fail "three frames: $(cat stderr)"
sed -n 2p long.vf >second.vf
"$radsubmit" --local -vf second.vf -x 40 -y 30 -pj 0 -dj 0 -o one.hdr "$room" \
    2>stderr || fail "one frame: $(cat stderr)"
sed "/^FRAME=2\$/d" all2.hdr | cmp - one.hdr || fail "another second frame"

# one view more than there may be
awk 'BEGIN { for (i = 0; i <= 65536; i++) print "rview -vp 2 1 1 -vd 0 1 0" }' \
    >many.vf
expect 64 "more than 65536 views" "65537 views" "$radsubmit" \
    --coordinator=127.0.0.1:9 --wait=0 -S 1 --views=many.vf $view \
    -o 'm%d.hdr' "$room"

# options of views without the word that makes a line one of a view
echo '-vp 2 1 1' >bare.vf
expect 65 "bare.vf: no view line, as 'VIEW= " "no view line" "$radsubmit" \
    --local -S 1 --views=bare.vf $view -o 'm%d.hdr' "$room"

cluster_finish
