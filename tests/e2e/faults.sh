# shellcheck shell=sh
# faults.sh - a cluster whose connections go through tests/tools/proxy; read
# with "." after cluster.sh
#
# faulty_start N THREADS: worker K reaches the coordinator through proxy cK, and
# other workers reach it through proxy pK; all by Unix sockets.
proxy=$top_builddir/tests/tools/proxy
proxies=

# proxy_start NAME LISTEN TARGET
proxy_start()
{
    mkfifo "$work/$1.do" || exit 99
    "$proxy" "$2" "$3" "$work/$1.do" 2>>"$work/$1.log" &
    proxies="$proxies $!"
    until_true 10 test -S "$2" || fail "proxy $1 does not listen"
}

# tell NAME COMMAND...: to one proxy
tell()
{
    name=$1
    shift
    echo "$*" >"$work/$name.do"
}

# faulty_worker K THREADS
faulty_worker()
{
    proxy_start "c$1" "$work/c$1.sock" "$sock"
    # shellcheck disable=SC2086 # options are words
    "$radd" --coordinator="$work/c$1.sock" --name="w$1" --threads="$2" \
        --listen="$work/w$1.sock" --cache="$work/w$1" \
        --ports-file="$work/w$1.ports" $worker_options 2>>"$work/w$1.log" &
    eval "pid_$1=$!"
    workers="$workers $1"
    wait_file "$work/w$1.ports"
    # a socket may be renamed while it listens
    mv "$work/w$1.sock" "$work/w$1.real"
    proxy_start "p$1" "$work/w$1.sock" "$work/w$1.real"
}

faulty_start()
{
    start_with faulty_worker "$@"
}

faulty_stop()
{
    for p in $proxies; do
        kill -TERM "$p"
    done
    proxies=
    cluster_stop
}

# inflict SHAPE K: make the connections of worker K bad; heal K undoes it
inflict()
{
    case $1 in
    both) tell "c$2" hold both && tell "p$2" hold both ;;
    up) tell "c$2" hold up && tell "p$2" hold up ;;
    down) tell "c$2" hold down && tell "p$2" hold down ;;
    drop) tell "c$2" drop && tell "p$2" drop ;;
    refuse) tell "c$2" refuse && tell "p$2" refuse ;;
    half) tell "c$2" halfopen && tell "p$2" halfopen ;;
    slow) tell "c$2" rate 60000 && tell "p$2" rate 60000 ;;
    torn) tell "c$2" delay 50 && tell "c$2" cut 9999 && tell "p$2" cut 777 ;;
    esac
}

heal()
{
    tell "c$1" well
    tell "p$1" well
    # what was half open is found out by silence; a test has not the time
    tell "c$1" gone
    tell "p$1" gone
}
shapes="both up down drop refuse half slow torn"
