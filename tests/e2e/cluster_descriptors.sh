#!/bin/sh
# cluster_descriptors.sh - few descriptors are enough for many frames and many
# uploads; where there are none for one more connection it waits, and nobody
# else does
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

[ -n "$(command -v prlimit)" ] || {
    echo "no prlimit to give a process few descriptors with"
    exit 77
}
few="prlimit --nofile=40:40"
sock=$work/c.sock
room=$scenes/room.rad
view="-x 8 -y 6 -ps 1 -ab 0"

# views N: a file of so many
views()
{
    i=0
    while [ $i -lt "$1" ]; do
        cat "$scenes/room.vf"
        i=$((i + 1))
    done >"views.$1"
}

# n_pictures PREFIX N: there are so many
n_pictures()
{
    n=$(find . -name "$1*.hdr" -size +0 | wc -l)
    [ "$n" -eq "$2" ] || fail "$1: $n pictures of $2"
}

coord_few()
{
    rm -f c.ports
    $few "$radcoord" --listen= --socket="$sock" --state=state \
        --ports-file=c.ports 2>>c.log &
    coord_pid=$!
    wait_file c.ports
}

worker_few()
{
    $few "$radd" --coordinator="$sock" --listen="$work/p.sock" --cache=w1 \
        --name=w1 --threads=1 2>>w1.log &
    pid_1=$!
    workers=1
}

views 1200
coord_few
worker_few
until_true 30 n_workers 1 || fail "the worker does not come"

# more frames than descriptors; the coordinator is killed in the middle
# shellcheck disable=SC2086 # options are words
"$radsubmit" --coordinator="$sock" --name=many $view -S 1 --views=views.1200 \
    --partition=window --windows=4 -o many%04d.hdr "$room" 2>many.err &
job=$!
until_true 60 in_the_middle_or_ended many
kill -KILL "$coord_pid"
wait "$coord_pid" 2>/dev/null
coord_few
wait $job || fail "many: $(cat many.err) $(tail -n 3 c.log)"
n_pictures many 1200

# many uploads that are begun and never come to an end, on one connection, and
# connections for which there is no descriptor, while another user works
cat >flood.py <<'PYTHON'
import struct, sys, wire

link = wire.Link(sys.argv[1])
link.s.settimeout(None)
for i in range(1000):
    link.send(wire.CHUNK, struct.pack('>I', i) * 8
              + struct.pack('>QQI', 0, 100, 10) + b'0123456789')
answers = b''
while answers.count(b'files at a time') < 1000 - 64:
    more = link.s.recv(65536)
    assert more, 'the connection ended'
    answers += more
others = [wire.connect(sys.argv[1]) for _ in range(60)]
print('ready', flush=True)
sys.stdin.read()
PYTHON
views 20
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=during $view -ab 1 -ad 300 -aa 0 -S 1 \
    --views=views.20 -o during%04d.hdr "$room" 2>during.err &
job=$!
until_true 60 in_the_middle_or_ended during
mkfifo hold
python3 flood.py "$sock" <hold >flood.out 2>&1 &
flood=$!
exec 9>hold
until_true 30 grep -q ready flood.out || fail "the flood: $(cat flood.out)"
until_true 30 grep -q 'connections wait' c.log || fail "no connection waits"
wait $job || fail "during: $(cat during.err) $(tail -n 3 c.log)"
n_pictures during 20
exec 9>&-
wait $flood || fail "the flood: $(cat flood.out)"
until_true 30 n_workers 1 || fail "nobody is let in after the flood"
grep -qE 'ending|failed' c.log && fail "$(grep -E 'ending|failed' c.log)"
cluster_stop

# the same in radsubmit's own cluster
views 300
# shellcheck disable=SC2086
$few "$radsubmit" --local $view -S 1 --views=views.300 -o local%04d.hdr \
    "$room" 2>stderr || fail "embedded: $(cat stderr)"
n_pictures local 300
for f in local*.hdr; do
    cmp "$f" "many${f#local}" || fail "$f differs"
done

# browsers that ask nothing leave radweb descriptors for its own connection: its
# coordinator comes when they are there, and before any of them has to go
coord_few
$few "$top_builddir/radweb" --coordinator="$work/web.sock" \
    --listen=127.0.0.1:0 --ports-file=web.ports 2>web.log &
web=$!
wait_file web.ports
cat >idle.py <<'PYTHON'
import select, socket, sys, time

port = int(open('web.ports').read().rsplit(':', 1)[1])
idle = [socket.create_connection(('127.0.0.1', port)) for _ in range(60)]
time.sleep(.5)  # radweb takes those that it will
open('idle.there', 'w').close()
while 'role=observer' not in open('c.log').read():
    if select.select(idle, [], [], .1)[0]:
        sys.exit('a browser had to go first')
PYTHON
python3 idle.py 2>idle.out &
idle=$!
until_true 30 test -e idle.there || fail "no browsers"
ln -s "$sock" web.sock
wait $idle || fail "radweb cannot reach its coordinator: $(cat idle.out)"
end_one $web radweb
cluster_stop

# with too few a daemon says so, and does not wait for more for ever
for daemon in "$radcoord" "$radd"; do
    expect 75 "at least 32 are needed" "$daemon with few" \
        prlimit --nofile=20:20 "$daemon"
done
# shellcheck disable=SC2086
expect 75 "at least 32 are needed" "radsubmit with few" \
    prlimit --nofile=20:20 "$radsubmit" --local $view -o few.hdr "$room"
for n in 5 9; do
    # shellcheck disable=SC2086
    expect 71 "too few descriptors" "radsubmit with $n" \
        prlimit --nofile=$n:$n "$radsubmit" --local $view -o few.hdr "$room"
    expect 71 "too few descriptors" "radctl with $n" \
        prlimit --nofile=$n:$n "$radctl" --coordinator="$sock" jobs
done
finish
