#!/bin/sh
# cluster_fair.sh - a user's small jobs get a worker while another user's large
# job fills its ambient cache: they are over when that is still at its passes
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

room=$scenes/room.rad

both_work()
{
    [ "$(said_of workers w1 state) $(said_of workers w2 state)" = \
        "working working" ]
}

at_passes()
{
    "$radctl" --coordinator="$sock" --json job "$large" |
        grep -q '"pass": [1-9]'
}

cluster_start 2 1
large=$("$radsubmit" --coordinator="$sock" --detach --name=large \
    -vf "$scenes/room.vf" -x 4000 -y 3000 -ab 4 -aa .02 -ar 512 -ad 16384 \
    -as 4096 --ambient=passes "$room" 2>stderr) || fail "large: $(cat stderr)"
until_true 60 both_work || fail "the large job does not begin"
until_true 60 at_passes || fail "the large job has no passes"

for bounces in 0 2; do
    : >small.err
    "$radsubmit" --coordinator="$tcp" --key=user.key -vf "$scenes/room.vf" \
        -x 64 -y 64 -ab $bounces -ad 64 -as 0 -o small.hdr "$room" \
        2>small.err &
    job=$!
    end_job small
    at_passes || fail "-ab $bounces: the large job did not let it go first"
done
"$radctl" --coordinator="$sock" cancel "$large" || fail "cancel"
cluster_finish
