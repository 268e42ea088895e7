#!/bin/sh
# disaster.sh - the coordinator is killed, loses power, or its disk or memory
# fails, at this or that write, sync, change of a name, message or allocation;
# started again, it goes on: the picture and the primary rays are those of a
# calm run, and no job that was accepted is lost
#
# RADD_SOAK=long tries every one of them, and 100 random moments (an hour or
# so), DISASTER_AT_ONCE (6) kinds of them beside each other, for most of it is
# waiting; else a few are drawn from DISASTER_SEED, which is printed.
#
# disaster.sh PART HOW KIND WHAT [FIRST] tries all of a kind, from the FIRST on
# (tests/tools/disaster.c says what they are; "moment none" is the random ones).
# DISASTER_ONLY="KIND:N:WHAT ..." tries just these, with DISASTER_PART=scanbar
# and the like, and DISASTER_HOW=detached.
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/chance.sh"

shim=$top_builddir/tests/tools/disaster.so
[ -e "$shim" ] || {
    echo "SKIP: no $shim"
    rm -rf "$work"
    exit 77
}

# What a long run tries: PART HOW KIND WHAT, those that take longest first.
everything()
{
    for part in window scanbar auto; do
        how=waited
        [ $part = auto ] && how=detached
        for kind in write sync name send; do
            for what in before after power bytes fail; do
                case $kind.$what in
                send.power | send.bytes | send.fail) continue ;;
                esac
                echo $part $how $kind $what
            done
        done
    done
    echo auto detached alloc fail
    echo auto detached moment none
    echo auto detached write full
    echo auto detached name full
}

if [ "${RADD_SOAK:-}" = long ] && [ $# -eq 0 ]; then
    # every one to its end, also when one of them finds something
    everything | xargs -L 1 -P "${DISASTER_AT_ONCE:-6}" sh -c \
        'sh "$0" "$@" >"$TMPDIR/out.$(echo "$@" | tr " " .)" 2>&1 </dev/null
        cat "$TMPDIR/out.$(echo "$@" | tr " " .)"' \
        "$top_srcdir/tests/soak/disaster.sh"
    grep -A 20 FAIL out.* && fail "see above"
    [ "$(grep -l 'disasters in' out.* | wc -l)" -eq "$(everything | wc -l)" ] ||
        fail "not all of them came to their end"
    finish
fi
draw_from "${DISASTER_SEED:-}"

reading=$top_srcdir/examples/reading-room
part=${1:-${DISASTER_PART:-auto}}
size="-x 160 -y 120"
# each row of a window is written by itself, and each write is a disaster
[ "$part" != window ] || size="-x 80 -y 60 --windows=6"
view="-vf room.vf $size -ps 4 -ds .1 -dj .7 -pj .7 -ab 0"
sock=$work/c.sock
starts=0

# The coordinator, with whatever is in the environment.
start()
{
    starts=$((starts + 1))
    rm -f c.ports
    env "$@" "$radcoord" --listen= --socket="$sock" --state="$work/state" \
        --ports-file="$work/c.ports" 2>>c.log &
    coord=$!
}

started_or_gone()
{
    [ -s c.ports ] || gone $coord
}

# It is not there: what it ended with is as it should be, and it starts again.
again()
{
    wait $coord 2>/dev/null
    status=$?
    case $status in
    137) ;; # killed
    71 | 73 | 74) ;; # no memory, also for a file; the disk failed
    *) fail "$point: the coordinator ended with $status" ;;
    esac
    start true=true
}

# The job, by one who waits for it, and who would submit it again were it lost.
# shellcheck disable=SC2086 # options are words
waited()
{
    (cd "$reading" && exec "$radsubmit" --coordinator="$sock" $view \
        --partition="$part" --stats="$work/out.json" -o "$work/out.hdr" \
        room.rad)
}

# By one who goes away when it is accepted: it must be there from then on.  A job
# that no memory was left to lay out has failed, before any work, and says so: it
# is submitted again.
# shellcheck disable=SC2086
detached()
{
    id=$(cd "$reading" && "$radsubmit" --coordinator="$sock" --detach $view \
        --partition="$part" room.rad) || return
    while :; do
        "$radctl" --coordinator="$sock" --json job "$id" >job.json 2>job.err
        case $? in
        0)
            grep -q '"state": "failed"' job.json &&
                grep -q '"text": "out of memory"' job.json && {
                detached
                return
            }
            grep -q '"state": "done"' job.json &&
                "$radctl" --coordinator="$sock" fetch "$id" -o out.hdr \
                    2>job.err && "$radctl" --coordinator="$sock" --json \
                    job "$id" >out.json 2>job.err && return
            ;;
        66)
            cat job.err >&2
            return 66
            ;;
        esac
        sleep .05
    done
}

# run POINT: one job with a disaster; $struck says whether it happened
run()
{
    point=$1
    rm -rf state struck out.hdr out.json backup.*
    start LD_PRELOAD="$shim" DISASTER="$point" DISASTER_DIR="$work/state" \
        DISASTER_LOG="$work/struck" DISASTER_COUNT="${2:-}"
    until_true 20 started_or_gone || fail "$point: the start hangs"
    gone $coord && again
    for k in 1 2; do
        "$radd" --coordinator="$sock" --name=w$k --threads=1 \
            --listen=127.0.0.$k:0 --cache="$work/cache$k" --nice=0 \
            2>>w.log &
        eval "worker_$k=$!"
    done
    "$how" 2>submit.err </dev/null &
    job=$!
    tries=0
    until gone $job; do
        gone $coord && again
        [ -z "${moment:-}" ] || [ $tries != "$moment" ] || {
            kill -KILL $coord
            echo killed >struck
        }
        tries=$((tries + 1))
        [ $tries -lt 60000 ] || {
            fail "$point: the job does not end"
            kill $job
        }
        sleep .01
    done
    wait $job || fail "$point: radsubmit ended with $?: $(cat submit.err)"
    # shellcheck disable=SC2154 # worker_1 is set with eval
    kill $worker_1 $worker_2
    wait $worker_1 $worker_2
    gone $coord && again
    until_true 20 started_or_gone
    kill -TERM $coord 2>/dev/null
    wait $coord
    struck=
    [ -e struck ] && struck=yes
}

# try POINT: and what must come of it
try()
{
    run "$1"
    cmp calm.hdr out.hdr || fail "$1: another picture"
    [ "$(total out.json primary_rays)" = "$primary" ] ||
        fail "$1: $(total out.json primary_rays) primary rays, not $primary"
    [ $failed = 0 ] || {
        tail -n 20 c.log
        finish
    }
    [ -z "$struck" ] || tried=$((tried + 1))
}

# What nothing befalls: calm.hdr, $primary, counts.
calm()
{
    run none:0:nothing "$work/counts"
    mv out.hdr calm.hdr
    primary=$(total out.json primary_rays)
    [ "$primary" -gt 0 ] || fail "the calm job has no primary rays"
    cat counts
}

how=waited
tried=0
calm

n_of()
{
    sed -n "s/^$1 //p" counts
}

# all_of KIND WHAT FIRST: one after the other, until one is not reached
all_of()
{
    n=$3
    if [ "$1" = moment ]; then
        while [ "$n" -le 100 ]; do
            any 150
            moment=$any
            try none:0:nothing
            # it may have been over before that
            [ -z "$struck" ] || n=$((n + 1))
        done
    else
        while try "$1:$n:$2" && [ -n "$struck" ]; do
            # of some tens of thousands of allocations, one in 30
            any=0
            [ "$1" != alloc ] || any 60
            n=$((n + 1 + any))
        done
    fi
    echo "$part $how $1 $2: $tried disasters in $starts lives"
}

if [ -n "${DISASTER_ONLY:-}" ]; then
    how=${DISASTER_HOW:-waited}
    for point in $DISASTER_ONLY; do
        try "$point"
        echo "$point: ${struck:-not reached}"
    done
    finish
fi
if [ $# -ge 4 ]; then
    how=$2
    all_of "$3" "$4" "${5:-1}"
    finish
fi
for kind in write sync name; do
    any 5
    what=$(echo before after power bytes fail | cut -d' ' -f $((any + 1)))
    any "$(n_of $kind)"
    try $kind:$((any + 1)):$what
done
how=detached
any "$(n_of send)"
try send:$((any + 1)):after
any 2000
try alloc:$((any + 1)):fail
any 60
moment=$any
try none:0:nothing
echo "$tried disasters in $starts lives"
[ $tried -gt 2 ] || fail "only $tried disasters happened"
finish
