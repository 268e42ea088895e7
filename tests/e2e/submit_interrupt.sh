#!/bin/sh
# submit_interrupt.sh - one interrupt cancels a job and says what it got;
# killing radsubmit leaves nothing of its cluster running
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

# Has process $pid ended?
ended() { ! ps -o stat= -p $pid | grep -qv '^Z'; }

# A picture that takes minutes: every pixel, many samples of the lamp.
start() # OPTIONS...
{
    : >stderr # what an earlier one said is no sign of this one
    interruptible "$radsubmit" --local "$@" --workers=2 --threads=1 \
        --progress=always -vf "$scenes/room.vf" -x 3000 -y 2250 -ps 1 \
        -ds .02 -dj 1 -o out.hdr "$scenes/room.rad" 2>stderr &
    pid=$!
    until_true 30 grep -q '2 workers' stderr || {
        fail "no progress"
        cat stderr
    }
}

# Somebody waits for the picture: it has the priority of what they do.
check_priority()
{
    child=$(pgrep -f -- "--child $work" | head -n 1)
    [ "$(ps -o ni= -p "$child")" = "$(ps -o ni= -p $pid)" ] ||
        fail "the job's process has another priority than radsubmit"
}

# while the scene is compiled: a command that never ends
mkfifo never
echo "!echo >'$work/runs'; cat '$work/never'" >waits.rad
for want in 75 3; do
    rm -f runs
    [ $want -eq 75 ] || set -- --rpict-status
    interruptible "$radsubmit" --local "$@" -o out.hdr waits.rad 2>stderr &
    pid=$!
    until_true 30 test -e runs || fail "the scene's command does not run"
    kill -INT $pid
    wait $pid
    status=$?
    [ $status -eq $want ] ||
        fail "interrupted early: exit status $status, not $want"
    check_nothing_left "interrupted early"
done

# while the coordinator starts: one that never serves
mkdir slow && cp "$radsubmit" slow/
printf '#!/bin/sh\nexec sleep 60\n' >slow/radcoord && chmod +x slow/radcoord
ln -s "$radd" slow/radd
interruptible ./slow/radsubmit --local -vf "$scenes/room.vf" -o out.hdr \
    "$scenes/room.rad" 2>stderr &
pid=$!
until_true 30 pgrep -P $pid -x sleep >/dev/null || fail "no slow coordinator"
kill -INT $pid
wait $pid
status=$?
[ $status -eq 75 ] || fail "interrupted at the start: exit status $status"
grep -qx 'radsubmit: interrupted' stderr || fail "it says: $(cat stderr)"
check_nothing_left "interrupted at the start"

start
kill -INT $pid
wait $pid
status=$?
[ $status -eq 75 ] || fail "interrupted: exit status $status"
grep -q 'cancelled: .* % of the pixels' stderr ||
    fail "it is not said what was got: $(cat stderr)"
[ ! -e out.hdr ] || fail "a picture that was cancelled is there"
check_nothing_left "interrupted"

start
check_priority
kill -TERM $pid
wait $pid
status=$?
[ $status -eq 75 ] || fail "terminated: exit status $status"
check_nothing_left "terminated"

for signal in INT TERM HUP; do # as rpict
    start --rpict-status
    kill -$signal $pid
    wait $pid
    status=$?
    [ $status -eq 3 ] || fail "$signal in the place of rpict: status $status"
done

# views from the standard input, each a radsubmit of its own
standin=$("$radsubmit" --rpict-path)/rpict
{ printf 'VIEW= '; cat "$scenes/room.vf"; } >views
for signal in INT TERM HUP; do
    : >stderr
    interruptible "$standin" -S 1 -t 1 -x 3000 -y 2250 -ps 1 -ds .02 -dj 1 \
        "$scenes/room.rad" <views >/dev/null 2>stderr &
    pid=$!
    until_true 30 grep -q 'rays/s' stderr || fail "no progress: $(cat stderr)"
    kill -$signal $pid
    until_true 30 ended || fail "$signal: a picture of rpict -S goes on"
    wait $pid
    status=$?
    [ $status -eq 3 ] || fail "$signal, rpict -S: exit status $status"
    check_nothing_left "$signal, rpict -S"
done

start
kill -KILL $pid
wait $pid 2>/dev/null
check_nothing_left "killed"

# while the picture goes to a reader that reads no more
mkfifo stuck
exec 3<>stuck
# stuck WHAT ARG...: both signals end a radsubmit whose output nobody reads on
stuck()
{
    what=$1
    shift
    for signal in INT TERM; do
        interruptible "$radsubmit" --local --threads=1 -vf "$scenes/room.vf" \
            -x 400 -y 300 -ab 0 "$@" "$scenes/room.rad" >stuck 2>stderr &
        pid=$!
        head -c 10 <&3 >/dev/null
        kill -$signal $pid
        until_true 10 ended || fail "$what: SIG$signal does not end it"
        kill -KILL $pid 2>/dev/null
        wait $pid 2>/dev/null
        check_nothing_left "$what: SIG$signal at a full pipe"
        timeout 1 cat <&3 >/dev/null # so that the pipe is empty for the next
    done
}
stuck "a picture"
# statistics with a row for each of many units
stuck "statistics" -o out.hdr --partition=window --windows=1000 \
    --stats=/dev/stdout
exec 3>&-

# while nobody reads what it says
mkfifo unread
exec 3<>unread
dd if=/dev/zero bs=4096 count=1000 of=unread oflag=nonblock 2>dd.err
interruptible "$radsubmit" --local --threads=1 --progress=always \
    -vf "$scenes/room.vf" -x 3000 -y 2250 -ps 1 -ds .02 -dj 1 -o out.hdr \
    "$scenes/room.rad" 2>unread &
pid=$!
until_true 30 pgrep -f -- "--child $work" >/dev/null || fail "no job"
ends_by_int()
{
    kill -INT $pid 2>/dev/null
    ended
}
until_true 10 ends_by_int || fail "interrupts do not end it while its messages wait"
kill -KILL $pid 2>/dev/null
wait $pid 2>/dev/null
check_nothing_left "interrupted while its messages wait"
exec 3>&-
finish
