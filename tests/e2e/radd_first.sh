#!/bin/sh
# radd_first.sh - a worker that is the first process of a container renders, and
# a job's process that is not the child of its radd ends at once
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

# With a link that is closed a child of this shell ends with EX_OSERR; a child
# of another process does not look at it.
: | "$radd" --child "$work" 1 0 0 0 '' $$ 3<&0
[ $? -eq 71 ] || fail "a child does not know its radd"
: | "$radd" --child "$work" 1 0 0 0 '' 1 3<&0 || fail "an orphan goes on"

container="unshare --pid --fork --mount-proc"
[ "$(id -u)" -eq 0 ] || container="$container --map-root-user"
# shellcheck disable=SC2086 # words
$container true 2>/dev/null || {
    echo "SKIP: no process can be the first of a namespace here"
    finish
}
coord_start
# shellcheck disable=SC2086
$container "$radd" --coordinator="$tcp" --key="$work/w1.key" --threads=1 \
    --listen=127.0.0.1:0 --cache="$work/w1" 2>w1.log &
shim=$!
until_true 30 n_workers 1 || fail "the worker does not come: $(cat w1.log)"
"$radsubmit" --coordinator="$sock" -vf "$scenes/room.vf" -x 32 -y 24 -ab 0 \
    -o room.hdr "$scenes/room.rad" 2>stderr ||
    fail "a container renders nothing: $(cat stderr w1.log)"
kill -TERM "$(pgrep -P $shim)"
wait $shim || fail "the worker ended with status $?"
cluster_finish
