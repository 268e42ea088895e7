#!/bin/sh
# cluster_cache.sh - a worker keeps its cache below a limit, and one that has no
# room for a job says so, fails nothing, and goes on when there is room
. "${top_srcdir:-.}/tests/e2e/small_disk.sh"
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

# scene NAME N: so many spheres, each in its own place: some 150 bytes each
scene()
{
    awk -v n="$2" -v seed="$1" 'BEGIN {
        print "void plastic grey 0 0 5 .5 .5 .5 0 0"
        print "void light lamp 0 0 3 9 9 9"
        print "lamp sphere l 0 0 4 0 0 90 9"
        for (i = 0; i < n; i++)
            printf "grey sphere %s%d 0 0 4 %d %d %d .4\n", seed, i,
                   i % 30 - 15, int(i / 30) % 30 - 15, int(i / 900) - 20
    }' >"$1.rad"
}

view="-vp 0 0 60 -vd 0 0 -1 -vu 0 1 0 -vh 40 -vv 40 -x 24 -y 24 -ps 1 -ab 0"

# render NAME SCENE
# shellcheck disable=SC2086 # options are words
render()
{
    "$radsubmit" --coordinator="$sock" --name="$1" $view -o "$1.hdr" \
        "$2.rad" >"$1.out" 2>"$1.err" </dev/null
}

done_as()
{
    wait "$job" || fail "$1: $(cat "$1.err")"
    cmp "$1.hdr" "$2" || fail "$1: another picture"
}

worker_is()
{
    said_of workers w1 state | grep -qx "$1" &&
        said_of workers w1 text | grep -q "$2"
}

job_says()
{
    said_of jobs "$1" text | grep -q "$2"
}

cached_kib()
{
    du -sk "$work/w1/files" | cut -f 1
}

scene a 4000
scene b 4000
scene c 22000
scene d 500

# --- a full disk
small_disk w1
printf 'cache_mib = 1\n' >w1.conf
worker_options="--config=$work/w1.conf"
cluster_start 1 1
fill
render full a &
job=$!
until_true 30 worker_is 'no room' '' || fail "radctl workers does not say it"
"$radctl" --coordinator="$sock" workers --state='no room' >listed 2>&1
grep -q '^w1 ' listed ||
    fail "workers in that state cannot be listed: $(cat listed)"
until_true 30 job_says full 'worker w1: ' || fail "radctl jobs does not say it"
until_true 30 grep -q '^radsubmit: the coordinator says: worker w1: ' full.err ||
    fail "radsubmit does not say it: $(cat full.err)"
grep -q 'job refused job=.* why=' w1.log || fail "radd's log does not say it"
grep -q 'worker has no room job=' c.log || fail "radcoord's log does not"
gone $job && fail "the job ended on a full disk: $(cat full.err)"

# who has room does it meanwhile, and the one without has other jobs when it can
worker_options=
worker_start 2 1
wait $job || fail "beside one that has room: $(cat full.err)"
mv full.hdr a.hdr
eval "end_one \$pid_2 'worker 2'"
workers=1
render again a &
job=$!
until_true 30 worker_is 'no room' '' || fail "a second time it is not said"
make_room
done_as again a.hdr
until_true 30 worker_is idle '' || fail "it has no room for ever"
grep -q 'room again job=' w1.log || fail "the log does not say that it has room"
grep -qE 'status 70|child lost' c.log && fail "a full disk counts as a crash"
ls w1/files/*.part 2>/dev/null && fail "something is left lying about"

# --- a disk that cannot be written to, for which only some reason may be known
if [ "$FULL_TMPFS" = yes ] && mount --bind w1/files w1/files &&
    mount -o remount,bind,ro w1/files; then
    render cached a || fail "of what is there: $(cat cached.err)"
    render sealed d &
    job=$!
    until_true 30 worker_is 'no room' 'Read-only' ||
        fail "radctl workers does not say that the disk is read-only"
    umount w1/files
    wait $job || fail "once it can be written to: $(cat sealed.err)"
fi

# --- a limit: the oldest goes, what is used stays
render bs b || fail "b: $(cat bs.err)"
render cs c &
job=$!
until_true 30 worker_is 'no room' cache_mib ||
    fail "a job above cache_mib: $("$radctl" --coordinator="$sock" workers)"
[ "$(cached_kib)" -le 1100 ] || fail "the cache has $(cached_kib) KiB"
render small a || fail "another job beside it: $(cat small.err)"
printf 'cache_mib = 12\n' >w1.conf
eval "kill -HUP \$pid_1"
wait $job || fail "with a larger limit: $(cat cs.err)"
printf 'cache_mib = 1\n' >w1.conf
eval "kill -HUP \$pid_1"
small_enough()
{
    [ "$(cached_kib)" -le 1100 ]
}
until_true 30 small_enough || fail "a smaller limit leaves $(cached_kib) KiB"
render anew a || fail "a again: $(cat anew.err)"
cmp anew.hdr a.hdr || fail "fetched again it is another picture"

# --- what is removed, cut or spoilt is fetched again
rm -rf w1/files
render removed a || fail "without a folder: $(cat removed.err)"
cmp removed.hdr a.hdr || fail "without a folder it is another picture"
[ "$(stat -c %a w1/files)" = 700 ] || fail "others may look into the new folder"
for f in w1/files/*; do
    truncate -s 100 "$f"
done
render cut a || fail "with cut files: $(cat cut.err)"
cmp cut.hdr a.hdr || fail "with cut files it is another picture"
eval "end_one \$pid_1 'worker 1'"
workers=
for f in w1/files/*; do # of the same length and age
    touch -r "$f" age
    printf '\377' | dd of="$f" bs=1 seek=99 conv=notrunc 2>/dev/null
    touch -r age "$f"
done
worker_options="--config=$work/w1.conf"
worker_start 1 1
until_true 30 worker_is idle '' || fail "it does not come back"
render flipped a || fail "with spoilt files: $(cat flipped.err)"
cmp flipped.hdr a.hdr || fail "with spoilt files it is another picture"
expect 73 'another process uses folder' 'two on one cache' \
    "$radd" --coordinator="$tcp" --key="$work/w2.key" --listen=127.0.0.1:0 \
    --cache="$work/w1"
cluster_stop
[ "$FULL_TMPFS" = no ] || umount w1
finish
