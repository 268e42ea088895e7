#!/bin/sh
# radd_hours.sh - a worker is there in its hours, and leaves after them with
# nothing left running
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

expect 64 "not 'never'" 'no hours' "$radd" --hours=never
expect 64 'idle_only needs nice' 'no nice' "$radd" --idle-only --nice=0

hour=$(date +%H)
hour=${hour#0}
cat >later <<EOF
hours = $(((hour + 2) % 24))-$(((hour + 3) % 24))
EOF
echo 'hours = 0-24' >always

cp later radd.conf
worker_options=--config=$work/radd.conf
coord_options=--log-level=debug
coord_start
worker_start 1 1
# one that is started after it has come, and it has not
worker_options=
worker_start 2 1
came()
{
    grep -q "hello peer=.* name=w$1 " c.log
}
until_true 30 came 2 || fail "worker 2 does not come"
came 1 && fail "it works before its hours"
# shellcheck disable=SC2154 # set by worker_start
end_one "$pid_2" "worker 2"
cp always radd.conf
kill -HUP "$pid_1"
until_true 10 came 1 || fail "it does not come in its hours"
# Its child stands still with a unit, so that the job lasts until the hours end; on
# a busy machine it may be through before that.
for _ in 1 2 3 4 5 6 7 8; do
    : >c.log
    "$radsubmit" --coordinator="$sock" --name=job -vf "$scenes/room.vf" -x 200 \
        -y 150 -ps 1 -ds .05 -dj 1 -ab 0 --partition=window --windows=60 \
        -o job.hdr "$scenes/room.rad" 2>job.err &
    job=$!
    until_true 30 grep -q 'unit out ' c.log || fail "the job does not start"
    child=$(child_of 1) && kill -STOP "$child" &&
        said_of jobs job state | grep -qx running && break
    kill -CONT "$child" 2>/dev/null
    wait $job
done
cp later radd.conf
kill -HUP "$pid_1"
until_true 20 grep -q 'work ends' w1.log || fail "it does not end its work"
kill -CONT "$child"
until_true 20 no_child 1 || fail "a child stays after the hours"
listed()
{
    "$radctl" --coordinator="$sock" workers | grep -qE "^w$1 +gone .* $2\$"
}
until_true 10 listed 1 'outside hours of its radd.conf' &&
    listed 2 'it was stopped' ||
    fail "why they are gone: $("$radctl" --coordinator="$sock" workers)"
"$radctl" --coordinator="$sock" jobs |
    grep -q 'no worker may work: 1 outside hours$' ||
    fail "why nobody works: $("$radctl" --coordinator="$sock" jobs)"
gone "$pid_1" && fail "the worker is gone"
gone $job && fail "the job is over: $(cat job.err)"
cp always radd.conf
kill -HUP "$pid_1"
wait $job || fail "the job: $(cat job.err)"
cluster_finish
