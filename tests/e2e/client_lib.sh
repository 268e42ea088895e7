# shellcheck shell=sh
# client_lib.sh - what the clients' tests share; read with "."
#
# Everything happens below $work, which is also the programs' TMPDIR: private
# folders and processes that outlive their test are found by its name.
set -u
: "${top_srcdir:=.}" "${top_builddir:=.}"
top_srcdir=$(cd "$top_srcdir" && pwd)
top_builddir=$(cd "$top_builddir" && pwd)
scenes=$top_srcdir/tests/scenes
radsubmit=$top_builddir/radsubmit
radctl=$top_builddir/radctl
radcoord=$top_builddir/radcoord
radd=$top_builddir/radd
failed=0

work=$(mktemp -d "${TMPDIR:-/tmp}/client.XXXXXX") || exit 99
export TMPDIR="$work" XDG_CONFIG_HOME="$work/config"
unset RADD_COORDINATOR
cd "$work" || exit 99

fail()
{
    echo "FAIL: $*"
    failed=1
}

# Were the programs built with a sanitizer, which keeps what is freed and takes its
# time?
is_sanitized()
{
    grep -q 'SANITIZED_TRUE"\]=""$' "$top_builddir/config.status" 2>/dev/null
}

# total FILE KEY: a count of a statistics file's totals
total()
{
    sed -n '/^ *"totals": {/,/}/s/^ *"'"$2"'": \([0-9]*\)[.0-9]*,*$/\1/p' "$1"
}

# What a picture has below its header.
body()
{
    LC_ALL=C sed '1,/^$/d' "$1"
}

# A background process of a shell starts with interrupts ignored, and below nohup
# hang-ups are; this one starts with neither.
interruptible()
{
    exec python3 -c 'import os, signal, sys
for ignored in signal.SIGINT, signal.SIGHUP:
    signal.signal(ignored, signal.SIG_DFL)
os.execv(sys.argv[1], sys.argv[1:])' "$@"
}

# The processes of this test, by the folder in their arguments.
left_over()
{
    pgrep -f -- "$work" | while read -r pid; do
        # not this script, which may have the folder in no argument but
        # whose subshells share its name
        [ "$pid" = $$ ] || echo "$pid"
    done
}

# The processes that have a launched worker's command line in theirs, of this
# test alone: radd's arguments name no folder of the test's, but its files are
# there.
of_launchers()
{
    pgrep -f -- "$radd --embedded --launched" | while read -r pid; do
        tr '\0' '\n' 2>/dev/null <"/proc/$pid/environ" |
            grep -qxF "TMPDIR=$work" && echo "$pid"
    done
}

# The workers among them: not the launchers' shells.
launched()
{
    of_launchers | while read -r pid; do
        [ "$(readlink "/proc/$pid/exe")" = "$radd" ] && echo "$pid"
    done
}

# until_true SECONDS COMMAND...: wait for a condition; false after so long on a
# machine that is not busy with other things.  One that is may need a good deal
# longer, minutes for what takes no time, and a sanitizer with it: only a test that
# fails has to wait for that.
until_true()
{
    tries=$(($1 * 10 * 5 + 1200))
    shift
    while ! "$@" >/dev/null 2>&1; do
        tries=$((tries - 1))
        [ "$tries" -gt 0 ] || return 1
        sleep .1
    done
}

nothing_left()
{
    [ -z "$(left_over)" ] && ! ls -d "$work"/radsubmit.* 2>/dev/null
}

# After radsubmit has ended its cluster has, too.
check_nothing_left()
{
    until_true 10 nothing_left || {
        fail "$1: something is left running or lying about:"
        left_over | xargs -r ps -o pid,stat,wchan:20,time,args -p
        ls -d "$work"/radsubmit.* 2>/dev/null
    }
}

# expect STATUS "TEXT IN THE MESSAGE" NAME COMMAND...
expect()
{
    want=$1 text=$2 name=$3
    shift 3
    "$@" >stdout 2>stderr </dev/null
    status=$?
    [ "$status" -eq "$want" ] || {
        fail "$name: exit status $status, expected $want"
        cat stderr
    }
    grep -qF -e "$text" stderr || {
        fail "$name: the message does not say '$text'"
        cat stderr
    }
}

# records FILE: how many ambient records of 114 bytes a file of -af has, at least
# those of units that count, and those that other attempts at them made
records()
{
    LC_ALL=C sed '1,/^$/d' "$1" | wc -c | awk '{ print $1 / 114 }'
}

finish()
{
    left_over | xargs -r kill -9 2>/dev/null
    cd / && rm -rf "$work"
    exit $failed
}
