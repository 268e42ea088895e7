# shellcheck shell=sh
# cluster.sh - a real coordinator and workers on addresses of their own; read
# with ".", and so is client_lib.sh
#
# cluster_start N THREADS gives $sock (the coordinator's Unix socket), $tcp (its
# address), worker K's process in pid_K and its files in $work/wK; over TCP it
# asks for keys: $work/wK.key, $work/user.key and $work/admin.key.
command -v until_true >/dev/null || . "${top_srcdir:-.}/tests/e2e/client_lib.sh"
# wire.py is there
export PYTHONPATH="$top_srcdir/tests/e2e" PYTHONDONTWRITEBYTECODE=1
poke=$top_builddir/tests/tools/poke
coord_pid=
workers=

wait_file()
{
    until_true 30 test -s "$1" || fail "$1 does not come"
}

# make_key ROLE:NAME FILE: with its line; the coordinator's file is $work/keys
make_key()
{
    (umask 077 && "$radctl" key add "$1" --keys="$work/keys" >"$work/$2") ||
        fail "no key for $1"
}

# the owner of what comes by user.key: a user's key is not the daemon's own login
ana=ana
[ "$(id -un)" != ana ] || ana=user:ana

make_keys()
{
    for k in 1 2 3 4 5 6 7 8 9; do
        make_key worker:w$k w$k.key
    done
    make_key user:ana user.key
    make_key admin:root admin.key
}

# shellcheck disable=SC2086 # options are words
coord_options=
coord_start()
{
    [ -e "$work/keys" ] || make_keys
    rm -f "$work/c.ports"
    "$radcoord" --listen=127.0.0.1:0 --keys="$work/keys" \
        --socket="$work/run/c.sock" --state="$work/state" \
        --ports-file="$work/c.ports" $coord_options 2>>"$work/c.log" &
    coord_pid=$!
    wait_file "$work/c.ports"
    sock=$work/run/c.sock # in a folder that was not there
    tcp=$(sed -n 's/^tcp //p' "$work/c.ports")
}

# The next coordinator, on the state and at the addresses of the one before.
# shellcheck disable=SC2086 # options are words
coord_again()
{
    "$radcoord" --listen="$tcp" --keys="$work/keys" --socket="$sock" \
        --state="$work/state" $coord_options 2>>"$work/c.log" &
    coord_pid=$!
}

# The coordinator is gone in the middle of whatever it does, and there is the next.
coord_crash()
{
    kill -KILL "$coord_pid"
    wait "$coord_pid" 2>/dev/null
    coord_again
}

# worker_start K THREADS: on 127.0.0.K, over TCP, with $worker_options
worker_options=
# shellcheck disable=SC2086 # options are words
worker_start()
{
    rm -f "$work/w$1.ports"
    "$radd" --coordinator="$tcp" --key="$work/w$1.key" --threads="$2" \
        --listen="127.0.0.$1:0" --cache="$work/w$1" \
        --ports-file="$work/w$1.ports" $worker_options 2>>"$work/w$1.log" &
    eval "pid_$1=$!"
    workers="$workers $1"
    wait_file "$work/w$1.ports"
}

n_workers()
{
    [ "$("$radctl" --coordinator="$sock" --json workers |
        grep -c '"name"')" -eq "$1" ]
}

# start_with WORKER N THREADS: the coordinator, and workers by that function
start_with()
{
    coord_start
    k=1
    while [ $k -le "$2" ]; do
        "$1" $k "$3"
        k=$((k + 1))
    done
    until_true 30 n_workers "$2" || fail "the workers do not come"
}

cluster_start()
{
    start_with worker_start "$@"
}

# cluster_start_looping X-Y: with one worker, which has the hooks of tests, and
# loop.rad, a room whose rendering does not get beyond that pixel
cluster_start_looping()
{
    {
        echo "void plastic test-loop-$1 0 0 5 .5 .5 .5 0 0"
        cat "$scenes/room.rad"
    } >loop.rad
    radd=$top_builddir/tests/tools/radd-hooked
    worker_options=--nice=0
    cluster_start 1 1
    radd=$top_builddir/radd
}

gone()
{
    ! kill -0 "$1" 2>/dev/null
}

# All that was started ends when asked, with status 0.
cluster_stop()
{
    for k in $workers; do
        eval "pid=\$pid_$k"
        gone "$pid" || end_one "$pid" "worker $k"
    done
    workers=
    end_one "$coord_pid" coordinator
    until_true 10 nothing_left || {
        fail "left running:"
        left_over | xargs -r ps -o pid,args -p
    }
    # a child's status is nobody's, but a sanitizer says what it found
    grep -h -A 30 'Sanitizer' ./*.log && fail "a sanitizer complains"
}

cluster_finish() # the end of a script
{
    cluster_stop
    finish
}

end_one()
{
    kill -TERM "$1"
    wait "$1"
    status=$?
    [ $status -eq 0 ] || fail "$2 ended with status $status"
}

# The process that renders for worker K; false when there is none.
child_of()
{
    pgrep -f -- "--child $work/w$1/"
}

no_child()
{
    ! child_of "$1"
}

# said_of jobs|workers NAME KEY: what radctl says of all rows with that name, a
# line for each
said_of()
{
    "$radctl" --coordinator="$sock" --json "$1" | sed -n '
        /^  "name": "'"$2"'",$/,/^ }/s/^  "'"$3"'": "*\([^"]*[^",]\)*"*,*$/\1/p'
}

# The job called $1 has got somewhere, and is not at its end.
in_the_middle()
{
    said_of jobs "$1" units_done | grep -q '^[1-9]'
}

# --- a job that is under way: radsubmit, which is process $job ---

job_ended()
{
    gone "$job"
}

in_the_middle_or_ended()
{
    in_the_middle "$1" || job_ended
}

# until_log PATTERN: it is in the coordinator's log, or the job has ended
until_log()
{
    pattern=$1
    until_true 60 logged_or_ended ||
        fail "no '$pattern': $(tail -n 3 "$work/c.log")"
}

logged_or_ended()
{
    grep -q "$pattern" "$work/c.log" || job_ended
}

# end_job NAME: it ends well, in a while; what it said is in NAME.err
end_job()
{
    until_true 60 job_ended || {
        fail "$1: the job does not end: $(tail -n 5 "$work/c.log")"
        kill "$job"
    }
    wait "$job" || fail "$1: $(cat "$work/$1.err")"
}
