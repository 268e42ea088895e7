#!/bin/sh
# cluster_sandbox.sh - a job's process is in its sandbox while it renders, says
# so where there is none, and nothing in a scene makes a daemon run a command
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

room=$scenes/room.rad

# the kernel as under valgrind: no seccomp
without_seccomp()
{
    LD_PRELOAD=/nowhere/vgpreload_none.so "$@"
}

expect 77 'sandbox is required' 'no seccomp' without_seccomp \
    "$radd" --coordinator="$work/none.sock" --listen=127.0.0.1:0 \
    --cache="$work/wx" --sandbox=required
expect 64 'auto' 'bad sandbox' "$radd" --sandbox=off

# nothing of radd's surroundings is the child's: neither what its environment
# holds, nor a descriptor that was left open, nor the folder it was started in
RADD_TEST_SECRET=sesame HOME=$work
export RADD_TEST_SECRET HOME
echo sesame >"$work/open"
exec 7<"$work/open"
cluster_start 1 1
pid=$pid_1
"$radsubmit" --coordinator="$sock" --name=long -vf "$scenes/room.vf" -x 1800 \
    -y 1350 -ps 1 -ds .02 -dj 1 -ab 0 --partition=window --windows=900 \
    --detach "$room" >id 2>stderr ||
    fail "detach: $(cat stderr)"
until_true 60 in_the_middle long || fail "the job does not start"
child=$(child_of 1)
status=/proc/$child/status
grep -q '^NoNewPrivs:.1' "$status" || fail "the child may gain privileges"
grep -q '^Seccomp:.2' "$status" || fail "the child has no filter"
[ "$(sed -n 's/^Seccomp_filters:.//p' "$status")" -ge 2 ] ||
    fail "the child is not sealed"
grep -q 'Max core file size  *0  *0' "/proc/$child/limits" ||
    fail "the child may leave a core"
[ "$(cat "/proc/$child/oom_score_adj")" -ge 500 ] ||
    fail "the kernel would not rather end the child than others"
for mask in SigBlk:.0000000000000000 'SigIgn:.*1002$'; do
    grep -q "^$mask" "$status" || fail "not $mask: $(grep ^Sig "$status")"
done
if ls "/proc/$child/fd" >/dev/null 2>&1; then
    for fd in "/proc/$child/fd"/*; do
        case $(readlink "$fd") in
        /*.log | /dev/null | pipe:* | anon_inode:*) ;;
        socket:*) echo "$fd" ;;
        *) fail "the child has $(readlink "$fd") open" ;;
        esac
    done >sockets
    [ "$(wc -l <sockets)" -eq 1 ] || fail "the child's sockets: $(cat sockets)"
    tr '\0' '\n' <"/proc/$child/environ" >environment
    grep -vE '^(LD_|GLIBC_TUNABLES=|[A-Z]+SAN_OPTIONS=|JOURNAL_STREAM=|TZ=)' \
        environment && fail "the child's environment has more than it needs"
    [ "$(readlink "/proc/$child/cwd")" = / ] ||
        fail "the child is in $(readlink "/proc/$child/cwd")"
elif [ "$(id -u)" -eq 0 ]; then
    fail "root cannot see what the child has open"
else # it cannot be looked into by its own user, which is as it should be
    echo "skipped: only root sees what the child has open"
fi
kill -KILL "$child"
until_true 10 grep -q 'child lost.*killed by signal 9.*memory' c.log ||
    fail "the coordinator does not tell why: $(grep lost c.log)"

# as where a container has its processes ended early: the child no later than radd
sealed()
{
    child=$(child_of "$1") &&
        [ "$(sed -n 's/^Seccomp_filters:.//p' "/proc/$child/status")" -ge 2 ]
}
echo 700 >/proc/self/oom_score_adj || fail "the score cannot be raised"
worker_start 2 1
until_true 30 sealed 2 || fail "worker 2 has no child"
[ "$(cat "/proc/$child/oom_score_adj")" -ge 700 ] ||
    fail "the kernel would rather end radd than the child"
"$radctl" --coordinator="$sock" cancel "$(cat id)" >/dev/null ||
    fail "no cancel"
for k in 1 2; do
    until_true 10 no_child $k || fail "the child of worker $k does not end"
done
gone "$pid" && fail "worker 1 is gone"
cluster_stop

# a command in a scene runs where it is compiled, never in a daemon: the daemons
# have nothing to run one with but libuv's, which starts the child
for daemon in "$radd" "$radcoord"; do
    nm -D --undefined-only "$daemon" >symbols ||
        fail "no symbols of $daemon"
    grep -wE 'system|popen|exec[lv]p?e?|fexecve|posix_spawnp?|fork|vfork' \
        symbols && fail "$daemon can run a command"
done
finish
