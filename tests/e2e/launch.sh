#!/bin/sh
# launch.sh - radsubmit --launch: workers that a command starts over the
# network give --local's picture; a command that fails, starts too few or none,
# or dies in the middle is told of, and nothing is left behind
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

room=$scenes/room.rad
quick="-vf $scenes/room.vf -x 120 -y 90 -ab 1 -ad 64 -as 16 --oversample=1
--threads=1 --address=127.0.0.1"
# half a minute at least
slow="--threads=1 --address=127.0.0.1 -vf $scenes/room.vf -x 900 -y 675 -ab 2
-aa .1 -ar 128 -ad 1024 -as 256 -ps 2 --oversample=1 --progress=never"

launched_left()
{
    left_over
    of_launchers
    ls -d "$work"/radsubmit.* "$work"/radd-launched-* 2>/dev/null
}

all_gone()
{
    [ -z "$(launched_left)" ]
}

check_gone() # NAME
{
    until_true 60 all_gone || {
        fail "$1: something is left: $(launched_left)"
        # shellcheck disable=SC2046
        ps -o pid,args -p $(launched_left | grep '^[0-9]*$') 2>/dev/null
    }
}

# try STATUS NAME OPTIONS...: stderr in NAME.err, the picture in NAME.hdr
try()
{
    want=$1 name=$2
    shift 2
    # shellcheck disable=SC2086
    "$radsubmit" $quick "$@" -o "$name.hdr" "$room" 2>"$name.err"
    status=$?
    [ $status -eq "$want" ] || fail "$name: exit status $status: $(cat "$name.err")"
    check_gone "$name"
}

says() # NAME TEXT
{
    grep -qF -e "$2" "$1.err" || fail "$1 does not say '$2': $(cat "$1.err")"
}

# the same bytes, header and all, but for rpict's line
quick_local=$(echo "$quick" | sed 's/--address=[^ ]*//')
# shellcheck disable=SC2086
"$radsubmit" --local $quick_local -o local.hdr "$room" 2>local.err ||
    fail "local: $(cat local.err)"

# one command for all workers, as srun and mpirun are, that hands on its
# environment
cat >all <<'END'
#!/bin/sh
n=$1
shift
for i in $(seq "$n"); do "$@" </dev/null & done
wait
END
# one for each, as ssh is, that hands on its standard input alone
cat >each <<'END'
#!/bin/sh
echo "$1" >>numbers
shift
exec env -i PATH="$PATH" TMPDIR="$TMPDIR" "$@"
END
chmod +x all each
try 0 all --launch="./all 3" --workers=3
cmp local.hdr all.hdr || fail "all: another picture"
says all "3 of 3 workers there: "
try 0 each --launch="./each %d" --workers=2
cmp local.hdr each.hdr || fail "each: another picture"
[ "$(sort numbers | tr '\n' ' ')" = "1 2 " ] || fail "numbers: $(cat numbers)"

# who ends too early, starts too few, starts none, forgets the key
try 69 status --launch="exit 3;" --workers=2
says status "the launcher ended with status 3: 0 of 2 workers came to 127.0.0.1:"
try 69 broken --launch="./each %d; exit %d;" --workers=2 --wait=0
says broken "of 2 workers"
for s in 4 16 64; do # on a busy machine fewer may come at first
    try 69 few --launch="./all 2" --workers=4 --wait=$s
    grep -q '2 of 4' few.err && break
done
says few "2 of 4 workers came to 127.0.0.1:"
says few " in $s s: "
try 69 none --launch="sleep 1000;" --wait=1
says none "0 of 1 workers came to 127.0.0.1:"
try 69 keyless --launch="env -u RADD_LAUNCH_KEY </dev/null"
says keyless "no key came, neither in RADD_LAUNCH_KEY nor by standard input"
for s in 1 4 16 64; do
    try 69 early --launch="exit 0;" --wait=$s
    grep -q 'the launcher has ended' early.err && break
done
says early " in $s s, and the launcher has ended"
for f in status broken few none keyless early; do
    [ ! -e $f.hdr ] || fail "$f: there is a picture"
done

# who prints what is no text goes to standard error, not into a picture; who
# starts more than asked is thanked
cat >noisy <<'END'
#!/bin/sh
head -c 100000 /dev/urandom
exec ./all 3 "$@"
END
# who forks and is gone, and leaves more than workers behind: that ends, too;
# MARK tells these from what another run of this test leaves
export MARK=$$
cat >forking <<'END'
#!/bin/sh
sleep 7654.$MARK &
trap '' HUP
(trap '' TERM; sleep 7655.$MARK) &
for i in 1 2; do "$@" </dev/null & done
END
chmod +x noisy forking
sleepers()
{
    pgrep -xf "sleep 765[45]\.$MARK"
}
no_sleepers()
{
    ! sleepers
}
# shellcheck disable=SC2086
"$radsubmit" $quick --launch=./noisy --workers=2 "$room" >noisy.hdr 2>noisy.err ||
    fail "noisy: $(tail -n 1 noisy.err)"
check_gone noisy
cmp local.hdr noisy.hdr || fail "noisy: another picture"
grep -qaF "3 workers there: " noisy.err || fail "noisy: more than asked"
try 0 forking --launch=./forking --workers=2
cmp local.hdr forking.hdr || fail "forking: another picture"
until_true 5 no_sleepers || fail "forking: left: $(sleepers)"

# a disk without room for the scene: nothing happens, and it is said why
cat >full <<'END'
#!/bin/sh
trap '' XFSZ
ulimit -f 1
exec "$@"
END
chmod +x full
# shellcheck disable=SC2086
setsid "$radsubmit" $quick --launch=./full -o full.hdr "$room" 2>full.err &
pid=$!
until_true 30 grep -q 'the coordinator says: worker .*: cannot write' \
    full.err || fail "full: $(cat full.err)"
kill -TERM $pid
wait $pid
check_gone full

# usage
expect 64 "--local and --launch exclude each other" both \
    "$radsubmit" --local --launch=srun "$room"
expect 64 "--launch and --coordinator exclude each other" two \
    "$radsubmit" --launch=srun --coordinator=x:1 "$room"
expect 64 "--address needs --launch" alone \
    "$radsubmit" --address=x:1 "$room"
expect 64 "--launch: expected a command" empty "$radsubmit" --launch=' ' "$room"
expect 64 "--address: expected HOST" address \
    "$radsubmit" --launch=srun --address=/x "$room"

has_workers() # N
{
    [ "$(launched | wc -l)" -ge "$1" ]
}

started() # NAME OPTIONS...: a long job whose workers are at it
{
    name=$1
    shift
    # shellcheck disable=SC2086
    setsid "$radsubmit" $slow "$@" -o "$name.hdr" "$room" 2>"$name.err" &
    pid=$!
    until_true 20 grep -q 'radsubmit: job' "$name.err" ||
        fail "$name: $(cat "$name.err")"
    until_true 10 has_workers 2 || fail "$name: no workers"
}

# nobody else sees the key: its file, its variable in the workers, all
# arguments; and the workers have wiped it from what /proc shows to their owner
started secret --launch="./all 2" --workers=2
key=$(sed 's/.* //' "$work"/radsubmit.*/keys)
[ ${#key} -eq 64 ] || fail "no key: $key"
[ "$(stat -c %a "$work"/radsubmit.*/keys)" = 600 ] || fail "others read the key"
ps -eo args | grep -v grep | grep -qF "$key" && fail "the key is in an argument"
wiped()
{
    for p in $(launched); do
        tr '\0' '\n' <"/proc/$p/environ" | grep -F "$key" && return 1
    done
    return 0
}
until_true 10 wiped || fail "worker $p still shows the key"

# killed: everything ends by itself
kill -9 $pid
wait $pid 2>/dev/null
check_gone "radsubmit killed"

# ... with what a launcher that has ended left behind
started forked --launch=./forking --workers=2
[ "$(sleepers | wc -l)" -eq 2 ] || fail "forked: no sleepers"
kill -9 $pid
wait $pid 2>/dev/null
check_gone "radsubmit killed after its launcher"
until_true 10 no_sleepers || fail "forked: left: $(sleepers)"

# ... a launcher that started nobody, too
waiting()
{
    pgrep -f "sleep 1000\.$MARK; "'"\$@"'
}
# shellcheck disable=SC2086
setsid "$radsubmit" $slow --launch="sleep 1000.$MARK;" -o x.hdr "$room" 2>x.err &
pid=$!
until_true 10 waiting || fail "no sleep"
kill -9 $pid
wait $pid 2>/dev/null
check_gone "radsubmit killed with a launcher that waits"
waiting >/dev/null && fail "the launcher is left"

# terminated: the same as killed
started term --launch="./all 2" --workers=2
kill $pid
wait $pid
status=$?
[ $status -eq 75 ] || fail "term: exit status $status: $(cat term.err)"
check_gone "radsubmit terminated"

# the launcher dies in the middle, and its workers with it; while radsubmit waits
# ten seconds for them to come back, another job's launcher is ended
cat >dying <<'END'
#!/bin/sh
"$@" & a=$!
"$@" & b=$!
until [ -e die ]; do sleep .1; done
kill -9 $a $b $$
END
chmod +x dying
no_workers() { [ -z "$(launched)" ]; }
started dying --launch="./dying" --workers=2
dying=$pid
: >die
until_true 10 no_workers || fail "dying: its workers live on"
rm -rf "$work"/radd-launched-* # which workers that are killed leave

# a launcher's end is many signals, to workers that are ending too
cat >stormy <<'END'
#!/bin/sh
"$@" & a=$!
"$@" & b=$!
until [ -e storm ]; do sleep .1; done
for i in 1 2 3 4 5 6 7 8; do kill -TERM $a $b; done 2>/dev/null
wait
END
chmod +x stormy
started stormy --launch="./stormy" --workers=2
: >storm
wait "$dying"
status=$?
[ $status -eq 69 ] || fail "dying: exit status $status: $(cat dying.err)"
says dying "no worker is left: the launcher ended with"
[ ! -e dying.hdr ] || fail "dying: there is a picture"
wait $pid
status=$?
[ $status -eq 69 ] || fail "stormy: exit status $status: $(cat stormy.err)"
check_gone "dying and stormy"

# one of two workers is killed: the picture is the same, and what it left is
# removed by the next worker once it is old
medium="-vf $scenes/room.vf -x 400 -y 300 -ab 1 -ad 256 -as 64 --oversample=1
--threads=1"
# shellcheck disable=SC2086
"$radsubmit" --local $medium -o whole.hdr "$room" 2>err || fail "whole: $(cat err)"
# shellcheck disable=SC2086
"$radsubmit" --launch="./all 2" --workers=2 --address=127.0.0.1 $medium \
    -o lost.hdr "$room" 2>lost.err &
pid=$!
until_true 20 grep -q 'radsubmit: job' lost.err || fail "lost: $(cat lost.err)"
launched | head -n 1 | xargs kill -9
wait $pid || fail "lost: $(cat lost.err)"
cmp whole.hdr lost.hdr || fail "a lost worker changes the picture"
touch -d '2 minutes ago' "$work"/radd-launched-* 2>/dev/null
try 0 swept --launch="./all 1"
finish
