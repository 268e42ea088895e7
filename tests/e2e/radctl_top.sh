#!/bin/sh
# radctl_top.sh - radctl top in a terminal (tmux): lists, a job, a question, a
# filter, a narrow terminal, a coordinator that goes and comes back, no colour,
# and a terminal that is as it was at any end
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

command -v tmux >/dev/null || {
    echo "radctl_top: no tmux here: not tested"
    rm -rf "$work"
    exit 77
}
export TERM=xterm-256color LC_ALL=C.UTF-8
unset NO_COLOR TMUX

expect 69 "" "no coordinator" "$radctl" --coordinator="$work/none" top --json

coordinator()
{
    "$radcoord" --listen= --socket="$work/socket" --state="$work/state" \
        --log-level=err 2>>coord.err &
    coord=$!
    until_true 10 "$radctl" --coordinator="$work/socket" status ||
        fail "radcoord: $(cat coord.err)"
}
coordinator
expect 64 "top is for a terminal" "no terminal" "$radctl" \
    --coordinator="$work/socket" top
for w in ws1 ws2; do
    "$radd" --coordinator="$work/socket" --name=$w --threads=1 --nice=0 \
        --cache="$work/cache-$w" --listen="$work/peer-$w" --log-level=err \
        2>>radd.err &
done
job=$("$radsubmit" --coordinator="$work/socket" --detach --name=atrium \
    -vf "$scenes/room.vf" -x 3600 -y 2700 -ab 2 -aa .1 -ar 128 -ad 16384 \
    -as 4096 -ps 2 --oversample=1 "$scenes/room.rad" 2>submit.err) ||
    fail "submit: $(cat submit.err)"
"$radsubmit" --coordinator="$work/socket" --detach --name='stairs é' \
    --priority=-5 -vf "$scenes/room.vf" "$scenes/room.rad" >/dev/null 2>&1

nservers=0 server=top$$
tm()
{
    tmux -L "$server" -f /dev/null "$@"
}
screen()
{
    tm capture-pane -p
}
shows() # PATTERN
{
    screen | grep -q -e "$1"
}
look() # PATTERN NAME
{
    until_true 10 shows "$1" || {
        fail "$2: no '$1' on the screen:"
        screen
    }
}
keys()
{
    tm send-keys "$@"
}
# the terminal's settings before and after, and what radctl ended with
cat >top.sh <<END
#!/bin/sh
trap : INT
stty -g >before
"$radctl" --coordinator="$work/socket" top
echo "ended with \$?"
stty -g >after
exec sleep 1000
END
chmod +x top.sh
start() # COLUMNS LINES
{
    rm -f before after
    tm kill-server 2>/dev/null
    server=top$$-$1-$((nservers += 1))
    tm new-session -d -x "$1" -y "$2" ./top.sh
}
ended() # STATUS NAME
{
    look "ended with $1" "$2"
    until_true 5 cmp before after || fail "$2: the terminal is not as it was"
}

start 120 24
look '^radcoord .* 2 workers, 2 threads   2 jobs' start
look '^WORKER .*LOAD .*THREADS .*UNITS .*RAYS/S .*REDUNDANT .*MEMORY .*CACHE' \
    "columns of workers"
look '^ws1  .* [0-9.]* [kM]  .* MiB ' "a worker's rays and memory"
look "^$(echo "$job" | cut -c1-8)  atrium .*running .* %" "the job"
look 'stairs .*waiting' "the second job"
[ "$(screen | wc -l)" -le 24 ] || fail "too many lines"
tm capture-pane -p -e | grep -q "$(printf '\033\\[3[36]m')" ||
    fail "no colour: $(tm capture-pane -p -e | head -n 3)"

keys / stairs
look 'filter: stairs_' filter
shows '  atrium ' && fail "the filter lets all through: $(screen)"
keys Escape
look '  atrium ' "filter off"

# into the job: the pass it is at, its workers
keys Enter
look "^job $(echo "$job" | cut -c1-8)  atrium" "the job's screen"
look '^running, .*pass [0-9] of [0-9]' "the job's passes"
look '^passes .*  [#=]*\.*$' "the passes' chart"
look '^ws2  .*  \.*$' "a worker without units yet"
keys q

# nothing happens without a yes
keys p
look 'pause job .* y/n' question
keys n
state()
{
    "$radctl" --coordinator="$work/socket" job "$job" | grep -q "state *$1"
}
state running || fail "paused without a yes"
keys p y
until_true 10 state paused || fail "not paused"
look 'atrium .*paused' "paused"
keys p
look 'go on with job .* y/n' "question to resume"
keys y
until_true 10 state running || fail "not resumed"
keys Tab d y
look '^ws. .*drain' drain
keys d y
until_true 10 sh -c "! tmux -L $server capture-pane -p | grep -q '^ws. .*drain'" ||
    fail "not undrained: $(screen)"

# other sizes
tm resize-window -x 44 -y 12
look '^JOB ' "a narrow terminal"
shows ADDRESS && fail "columns that do not fit: $(screen)"
tm resize-window -x 120 -y 24
look ADDRESS "wide again"

# the coordinator is lost, and back
kill -9 $coord
wait $coord 2>/dev/null
look "cannot connect\|no coordinator\|refused\|lost\|ended" "the loss"
shows '  atrium ' || fail "what was known is gone: $(screen)"
coordinator
look 'the coordinator is there again' "back"
look '^ws1 .*\(idle\|working\|loading\)' "workers back"

keys Tab Enter
look "^job .*  atrium" "the job's screen again"
keys c
look 'cancel job .* y/n' "question to cancel"
keys y
until_true 10 state cancelled || fail "not cancelled"
look '^cancelled, ' "a job that ends while it is looked at"
keys q
until_true 10 sh -c "! tmux -L $server capture-pane -p | grep -q '  atrium '" ||
    fail "a cancelled job is open"
keys a
look 'atrium .*cancelled' "jobs that are over"
keys q
ended 0 quit

# a signal; no colour
export NO_COLOR=1
start 80 24
look '^radcoord ' "without colour"
tm capture-pane -p -e | grep -q "$(printf '\033\\[3[0-7]m')" &&
    fail "NO_COLOR: $(tm capture-pane -p -e | head -n 3)"
pkill -TERM -f "^$radctl --coordinator=$work/socket top" || fail "no radctl"
ended 0 SIGTERM
start 80 24
look '^radcoord ' "once more"
keys C-c
ended 0 SIGINT
tm kill-server
server=top$$-c
tm new-session -d -x 80 -y 24 env LC_ALL=C ./top.sh
look '^radcoord ' "without a language"
keys a
look 'stairs é' "a name that is not ASCII"
tm kill-server
server=top$$-dumb
tm new-session -d -x 80 -y 24 env TERM=dumb ./top.sh
look 'ended with 64' "a terminal that has no screen"
shows 'TERM=dumb' || fail "no screen: $(screen)"
tm kill-server
finish
