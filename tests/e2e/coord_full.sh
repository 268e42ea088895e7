#!/bin/sh
# coord_full.sh - on a full disk a job is held, and says so; when there is room
# it goes on
. "${top_srcdir:-.}/tests/e2e/small_disk.sh"
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

view="-vf $scenes/room.vf -x 400 -y 300 -ps 1 -ds .1 -dj 1 -ab 0
--partition=window --windows=40"
room=$scenes/room.rad

small_disk state
# room for the scene, not for the rows
make_some_room()
{
    [ $FULL_TMPFS = no ] || {
        rm state/crumbs
        truncate -s -256K state/ballast
    }
}

no_rows()
{
    ! ls state/jobs/*/*.rows >ls.out 2>&1
}

says_held()
{
    grep -q "held: the coordinator's disk is full" "$1.err"
}

status_says_full()
{
    "$radctl" --coordinator="$sock" status | grep -q '^disk  *full'
}

status_has_room()
{
    "$radctl" --coordinator="$sock" status >status.out && ! status_says_full
}

is_held()
{
    "$radctl" --coordinator="$sock" --json jobs >jobs.json &&
        grep -q '"state": "held"' jobs.json &&
        grep -q 'no room on the disk: its rows need' jobs.json
}

# shellcheck disable=SC2086 # options are words
"$radsubmit" --local --workers=1 --threads=1 $view -o alone.hdr "$room" \
    2>stderr || fail "embedded: $(cat stderr)"
cluster_start 2 1
fill
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" $view -o held.hdr "$room" 2>held.err &
job=$!
until_true 30 says_held held || fail "radsubmit does not say that it is held"
until_true 30 status_says_full ||
    fail "radctl status does not say that the disk is full"
make_some_room
[ $FULL_TMPFS = no ] ||
    until_true 30 is_held || fail "radctl does not say that it is held"
gone $job && fail "the job ended on a full disk: $(cat held.err)"
grep -q 'disk full, jobs are held' c.log || fail "the log does not say it"
make_room
wait $job || fail "held: $(cat held.err)"
grep -q 'the job goes on' held.err || fail "radsubmit does not say it goes on"
cmp alone.hdr held.hdr || fail "the picture after a full disk differs"

# full again, while a job is under way
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=again $view -o again.hdr "$room" \
    2>again.err &
job=$!
until_true 60 in_the_middle again || fail "the second job does not start"
fill
sleep .3
make_some_room
make_room
wait $job || fail "again: $(cat again.err)"
cmp alone.hdr again.hdr || fail "the picture after a second time differs"

# and again: a job that is under way is cancelled, which cannot be kept now;
# whoever asks for it does not wait for that
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=ends $view -ab 1 -aa 0 -ad 200 \
    -as 0 -o ends.hdr "$room" 2>ends.err &
job=$!
until_true 60 in_the_middle ends || fail "the third job does not start"
fill
id=$(sed -n 's/^radsubmit: job //p' ends.err)
timeout 600 "$radctl" --coordinator="$sock" cancel "$id" 2>stderr
status=$?
echo "cancel of a job that is held under way: $status"
case $status in
0) ;; # what was written had its room
75) grep -q 'it is done, but the coordinator.s disk is full' stderr ||
    fail "cancel: $(cat stderr)" ;;
*) fail "a job that is held under way cannot be cancelled: $(cat stderr)" ;;
esac
is_over()
{
    "$radctl" --coordinator="$sock" --json jobs >jobs.json &&
        grep -q '"state": "cancelled"' jobs.json
}
if [ $FULL_TMPFS = yes ]; then
    # its rows are gone, which makes room for others
    until_true 30 no_rows || fail "rows are left: $(ls state/jobs/*)"
    # shellcheck disable=SC2086
    timeout 600 "$radsubmit" --coordinator="$sock" $view -x 40 -y 30 \
        -o less.hdr "$room" 2>less.err ||
        fail "a cancelled job left no room: $(cat less.err)"
fi
make_some_room
make_room
wait $job && fail "a job that was cancelled under way is done"
until_true 30 is_over || fail "it is not cancelled: $(cat jobs.json)"
# and that is kept, as what comes after it is
# shellcheck disable=SC2086
timeout 600 "$radsubmit" --coordinator="$sock" $view -x 40 -y 30 -o small.hdr \
    "$room" 2>small.err || fail "there is room, but nothing goes on"

# a coordinator that ends while it is full loses nothing, and begins again while
# it is: a job that has its room can be cancelled, which makes room for another
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --detach $view -x 800 -y 600 "$room" \
    >kept.id 2>stderr || fail "kept: $(cat stderr)"
"$radctl" --coordinator="$sock" pause "$(cat kept.id)" || fail "pause it"
fill
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" $view -o last.hdr "$room" 2>last.err &
job=$!
until_true 30 says_held last || fail "the last does not say that it is held"
kill -TERM "$coord_pid"
wait "$coord_pid" || fail "a full coordinator ends with $?"
coord_again
until_true 30 status_says_full ||
    fail "a coordinator does not begin on a full disk: $(tail -n 3 c.log)"
timeout 600 "$radctl" --coordinator="$sock" cancel "$(cat kept.id)" 2>stderr
status=$?
[ $status -eq 0 ] || [ $status -eq 75 ] || fail "cancel: $(cat stderr)"
[ $FULL_TMPFS = yes ] || make_room
wait $job || fail "last: $(cat last.err)"
cmp alone.hdr last.hdr || fail "the picture of another life differs"
make_room
coord_crash # the life that began so has its number
until_true 30 status_has_room || fail "the disk is full for ever"
"$radctl" --coordinator="$sock" job "$(cat kept.id)" | grep -q cancelled ||
    fail "that it was cancelled is lost"

if [ $FULL_TMPFS = yes ]; then
    # what can never have its room does not wait for it
    # shellcheck disable=SC2086
    expect 65 "MiB, and the coordinator's disk has 16 in all" \
        "too large" "$radsubmit" --coordinator="$sock" $view -x 4000 -y 4000 \
        -o large.hdr "$room"

    # a scene that is larger than the room that is left is refused, and nobody
    # else has to wait for it
    awk 'BEGIN { print "void plastic p 0 0 5 .5 .5 .5 0 0"
        for (i = 0; i < 40000; i++)
            print "p polygon a" i " 0 0 9", i, 0, 0, i + 1, 0, 0, i, 1, i % 7
    }' >many.rad
    fill
    rm state/crumbs
    truncate -s -3M state/ballast
    # shellcheck disable=SC2086
    expect 75 "no room on the coordinator's disk for a file of" \
        "a large scene" "$radsubmit" --coordinator="$sock" $view -o many.hdr \
        many.rad
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" $view -o beside.hdr "$room" \
        2>beside.err || fail "beside: $(cat beside.err)"
    says_held beside && fail "a job is held for another's scene"
    [ -z "$(ls state/files/*.part 2>/dev/null)" ] ||
        fail "what came of a refused scene is not removed"
    rm state/ballast

    # one that waits for more than there is waits alone; the log of the database
    # gives back what it holds
    fill
    rm state/crumbs
    truncate -s -4M state/ballast
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" --name=more $view -x 2000 -y 1500 \
        -o more.hdr "$room" 2>more.err &
    more=$!
    until_true 30 says_held more || fail "more: it is not held: $(cat more.err)"
    until_true 30 is_held ||
        fail "radctl does not say that it is held: $(cat jobs.json)"
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" $view -o after.hdr "$room" \
        2>after.err || fail "after: $(cat after.err)"
    says_held after && fail "a job is held for another's want"
    cmp alone.hdr after.hdr || fail "the picture beside one that waits differs"
    # who goes away from one that waits is told that it stays; an interrupt
    # cancels it
    for signal in TERM INT; do
        : >stays.err
        # shellcheck disable=SC2086
        interruptible "$radsubmit" --coordinator="$sock" --name=stays $view \
            -x 2000 -y 1500 -o stays.hdr "$room" 2>stays.err &
        stays=$!
        until_true 30 grep -q '^radsubmit: job ' stays.err ||
            fail "a job that waits has no id: $(cat stays.err)"
        until_true 30 says_held stays || fail "stays: $(cat stays.err)"
        id=$(sed -n 's/^radsubmit: job //p' stays.err)
        kill -$signal $stays
        wait $stays
        [ $? -eq 75 ] || fail "SIG$signal: $(cat stays.err)"
        case $signal in
        TERM)
            grep -q "the job stays, and goes on when the .*'s disk has room:" \
                stays.err || fail "it is not said: $(cat stays.err)"
            "$radctl" --coordinator="$sock" cancel "$id" || fail "cancel it"
            ;;
        INT)
            grep -q '^radsubmit: cancelled: ' stays.err ||
                fail "not cancelled: $(cat stays.err)"
            grep -q 'goes on' stays.err &&
                fail "a job that is cancelled goes on: $(cat stays.err)"
            "$radctl" --coordinator="$sock" job "$id" | grep -q cancelled ||
                fail "it is there: $("$radctl" --coordinator="$sock" jobs)"
            ;;
        esac
    done

    # paused meanwhile, it is so when it has its room, in another life too
    id=$(sed -n 's/^radsubmit: job //p' more.err)
    "$radctl" --coordinator="$sock" pause "$id" || fail "it cannot be paused"
    rm state/ballast
    has_room()
    {
        grep -q "job has room job=$id" c.log
    }
    until_true 30 has_room || fail "it does not get the room that there is"
    "$radctl" --coordinator="$sock" resume "$id" || fail "it cannot go on"
    "$radctl" --coordinator="$sock" pause "$id" || fail "it cannot be paused"
    coord_crash
    is_paused()
    {
        "$radctl" --coordinator="$sock" --json jobs >jobs.json &&
            grep -q '"state": "paused"' jobs.json
    }
    until_true 30 is_paused || fail "it is not paused: $(cat jobs.json)"
    "$radctl" --coordinator="$sock" cancel "$id" 2>stderr ||
        fail "it cannot be cancelled: $(cat stderr)"
    wait $more && fail "a cancelled job is done"
fi
cluster_stop
[ $FULL_TMPFS = no ] || umount state
finish
