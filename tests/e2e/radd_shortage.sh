#!/bin/sh
# radd_shortage.sh - a worker that may start no process for a while waits, and
# its job with it
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

[ -n "$(command -v prlimit)" ] || {
    echo "no prlimit to forbid a process to start others with"
    exit 77
}
# root may start as many as it likes, so there it is nobody's worker
as=
if [ "$(id -u)" = 0 ]; then
    as="setpriv --reuid=65534 --regid=65534 --clear-groups"
    $as test -x "$radd" || {
        echo "an ordinary user cannot run $radd"
        exit 77
    }
    chmod 711 "$work"
fi

# a program that gets no threads says so, and does not end by SIGABRT; a thread
# sanitizer has one of its own first
mkdir none && chmod 777 none
is_sanitized || for program in "$radcoord --state=$work/none" \
    "$radd --coordinator=$work/none --cache=$work/none" \
    "$radsubmit -vf $scenes/room.vf -o none/none.hdr $scenes/room.rad"; do
    # shellcheck disable=SC2086 # words of a command
    expect 75 'cannot start a thread' "no thread: ${program%% *}" \
        $as prlimit --nproc=1 $program
    # the pool may also be larger than usual
    expect 75 'cannot start a thread' "40 threads: ${program%% *}" \
        $as env UV_THREADPOOL_SIZE=40 prlimit --nproc=20 $program
done

# nor where there is room for the threads, and for little else; a cluster that
# lacks them has no bug of ours
for n in 5 6 8 10 12 13 14 15; do
    for where in --local "--coordinator=$work/none.sock"; do
        is_sanitized ||
            $as prlimit --nproc=$n "$radsubmit" "$where" --wait=1 \
                --workers=1 --threads=2 -vf "$scenes/room.vf" -x 16 -y 12 -ab 0 \
                -o none/none.hdr "$scenes/room.rad" >out 2>&1
        case $? in
        70 | 1[3-9]?) fail "$where with $n processes: $(cat out)" ;;
        esac
    done
done

coord_start
if [ -n "$as" ]; then
    mkdir w1
    touch w1.ports w1.log
    chown 65534 w1 w1.key w1.ports w1.log
fi
$as "$radd" --coordinator="$tcp" --key="$work/w1.key" --threads=1 \
    --listen=127.0.0.1:0 --cache="$work/w1" 2>>w1.log &
pid_1=$!
workers=1
until_true 30 n_workers 1 || fail "the worker does not come: $(cat w1.log)"

$as prlimit --pid="$pid_1" --nproc=1: || {
    echo "no limit can be set"
    cluster_stop
    exit 77
}
"$radsubmit" --coordinator="$sock" -vf "$scenes/room.vf" -x 40 -y 30 -ps 1 \
    -ab 0 -o room.hdr "$scenes/room.rad" 2>err &
job=$!
until_true 30 grep -q 'child waits for a process' w1.log ||
    fail "it does not wait: $(cat w1.log)"
gone $job && fail "the job did not wait: $(cat err)"
$as prlimit --pid="$pid_1" --nproc=4096: || fail "no other limit"
wait $job || fail "$(cat err)"
grep -q 'child lost' w1.log && fail "$(grep 'child lost' w1.log)"

# one that is cancelled while it waits leaves nothing behind
$as prlimit --pid="$pid_1" --nproc=1:
: >w1.log
"$radsubmit" --coordinator="$sock" -vf "$scenes/room.vf" -x 40 -y 30 -ps 1 \
    -ab 0 -o again.hdr "$scenes/room.rad" 2>err &
job=$!
until_true 30 grep -q 'child waits for a process' w1.log ||
    fail "it does not wait again: $(cat w1.log)"
until_true 30 grep -q '^radsubmit: job ' err || fail "no id: $(cat err)"
id=$(sed -n 's/^radsubmit: job //p' err)
"$radctl" --coordinator="$sock" cancel "$id" || fail "it cannot be cancelled"
wait $job && fail "a cancelled job is done"
cluster_finish
