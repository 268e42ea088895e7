#!/bin/sh
# points_stream.sh - sensor points on a pipe: answered while more come, in their
# order, and what is wrong behind them loses none
# shellcheck disable=SC2086,SC2002 # options are words, and cat makes a pipe
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

# inside of a sphere that shines all is known
cat >box.rad <<'END'
void glow shine 0 0 4 2 2 2 0
shine bubble box 0 0 4 0 0 0 10
END

# who waits for an answer before he says the next point gets it
mkfifo ask
"$radsubmit" --local --threads=1 --points=- -h- -ovL box.rad <ask >answers \
    2>stderr &
waits=$!
exec 3>ask
answered() { [ "$(wc -l <answers)" -eq "$1" ]; }
for n in 1 2 3; do
    echo "$n 0 0 1 0 0" >&3
    until_true 30 answered $n || fail "no answer to point $n: $(cat stderr)"
done
exec 3>&-
wait $waits || fail "three questions: $(cat stderr)"
awk '{ if ($1 != 2 || ($4 - (10 - NR))^2 > 1e-8) exit 1 }' answers ||
    fail "answers: $(cat answers)"

# a socket that is input and output at once, and full when the answers come
cat >both.py <<'PYTHON'
import socket, subprocess, sys, time

N = 4000
ours, its = socket.socketpair()
its.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
p = subprocess.Popen(sys.argv[1:], stdin=its, stdout=its)
its.close()
ours.sendall(b'1 0 0 1 0 0\n' * N)
ours.shutdown(socket.SHUT_WR)
first = ours.recv(1)
time.sleep(1) # in which it fills the socket
n = first.count(b'\n')
while True:
    more = ours.recv(65536)
    if not more:
        break
    n += more.count(b'\n')
assert p.wait() == 0 and n == N, '%d answers' % n
PYTHON
if command -v python3 >/dev/null; then
    python3 both.py "$radsubmit" --local --threads=1 --points=- -h- -ov \
        box.rad 2>stderr || fail "a socket: $(cat stderr)"
fi

# what is wrong in the scene is told of all batches: a function's faults at the
# end, together
cat >log.rad <<'END'
void brightfunc half 2 'if(Px,log(0),1)' . 0 0
half glow h 0 0 4 1 1 1 0
h bubble box 0 0 4 0 0 0 10
END
: >answers
"$radsubmit" --local --threads=1 --points=- -h- -ov log.rad <ask >answers \
    2>stderr &
waits=$!
exec 3>ask
for n in 1 2 3; do # the last one sees no fault
    echo "0 0 0 $((5 - 2 * n)) 0 0" >&3
    until_true 30 answered $n || fail "no answer to point $n: $(cat stderr)"
done
exec 3>&-
wait $waits || fail "a fault: $(cat stderr)"
[ "$(sed -n "s/.*'half': no value in \([0-9]*\) place.*/\1/p" stderr)" = 2 ] ||
    fail "faults of all batches: $(cat stderr)"

# without a cache a value is the same however points are cut, noise and all
awk 'BEGIN { for (i = 0; i < 4000; i++)
    printf "%g %g .8 0 0 1\n", .2 + i % 80 / 24, .2 + int(i / 80) / 15 }' >grid
room=$scenes/room.rad
opts='-I -h- -fad -dj 1 -ds 0 -ab 0'
"$radsubmit" --local --threads=1 --points=grid $opts "$room" >whole.bin \
    2>stderr || fail "a file: $(cat stderr)"
"$radsubmit" --local --threads=1 --points=- --stats=stats.json $opts \
    "$room" <ask >cut.bin 2>stderr &
waits=$!
exec 3>ask
head -n 100 grid >&3
has_100() { [ "$(wc -c <cut.bin)" -eq 2400 ]; }
until_true 30 has_100 || fail "no answer to 100 points: $(cat stderr)"
tail -n +101 grid >&3
exec 3>&-
wait $waits || fail "with a pause: $(cat stderr)"
cmp whole.bin cut.bin || fail "values depend on how points are cut"
[ "$(grep -c '"fingerprint"' stats.json)" -ge 3 ] || fail "statistics of batches"

# with one, points that come without a pause are cut by their number alone, and
# each batch begins with what those before it have left; all are in the pipe before
# somebody reads
all_of() # FILE COMMAND...: of 64 KiB at most
{
    exec 5<>ask 4<ask
    cat "$1" >&5
    exec 5>&-
    shift
    "$@" <&4 4<&-
    status=$?
    exec 4<&-
    return $status
}
opts='-I -h- -fad -ab 1 -ad 64 -as 0 -aa .2'
(head -n 1024 grid && head -n 1024 grid) >twice
for w in 1 4; do
    all_of twice "$radsubmit" --local --workers=$w --threads=1 --points=- \
        $opts --stats=stats.json "$room" >by$w.bin 2>stderr ||
        fail "$w workers: $(cat stderr)"
done
cmp by1.bin by4.bin || fail "one worker and four"
awk '/"ambient_values"/ { n[++k] = $2 + 0 }
    END { if (k != 2 || n[1] < 100 || n[2] > n[1] / 4) exit 1 }' stats.json ||
    fail "a batch begins without records: $(grep ambient_values stats.json)"

# what is wrong is named, and nothing before it is lost, also not in a file
(head -n 1500 grid && echo 1 2 3 4 5 six && cat grid) >wrong
for to in - file; do
    cat wrong | "$radsubmit" --local --threads=1 --points=- -I -h- -ab 0 \
        -o $to "$room" >out 2>stderr
    [ $? -eq 65 ] || fail "a wrong line: $(cat stderr)"
    grep -q "stdin:1501: 'six' is not a number" stderr ||
        fail "which line: $(cat stderr)"
    [ $to = - ] || mv file out
    [ "$(wc -l <out)" -eq 1500 ] || fail "values before a wrong line, $to"
done
"$radsubmit" --local --threads=1 --points=grid -I -h- -ab 0 "$room" >all \
    2>stderr || fail "a file: $(cat stderr)"
head -n 1500 all | cmp - out || fail "values before a wrong line"
head -c 1000 whole.bin | "$radsubmit" --local --threads=1 --points=- -fda \
    -h- -oo box.rad >out 2>stderr
[ $? -eq 65 ] || fail "bytes behind the last point: $(cat stderr)"
grep -q "40 bytes behind sensor point 20" stderr || fail "$(cat stderr)"
[ "$(wc -l <out)" -eq 20 ] || fail "20 points: $(cat out)"
: | "$radsubmit" --local --points=- box.rad >out 2>stderr
[ $? -eq 65 ] || fail "no points: $(cat stderr)"
head -n 5 grid | "$radsubmit" --local --points=- --time=9 -ab 1 "$room" >out \
    2>stderr
[ $? -eq 64 ] || fail "--time: $(cat stderr)"
grep -q -- '--time is for one job' stderr || fail "--time: $(cat stderr)"

# no more points are read than -x and -y ask for
head -n 9 grid | "$radsubmit" --local --points=- -x 2 -y 3 -fac -ab 0 -I \
    "$room" >out 2>stderr || fail "-x -y: $(cat stderr)"
[ "$(sed '1,/^-Y 3 +X 2$/d' out | wc -c)" -eq 24 ] || fail "-x -y: $(wc out)"

check_nothing_left "points on a pipe"

# a coordinator keeps no job of a batch, and -af keeps the records of all
RADD_COORDINATOR=$work/coord.sock
export RADD_COORDINATOR
"$radcoord" --listen= --socket="$RADD_COORDINATOR" --state="$work/state" \
    2>>coord.log &
until_true 20 "$radctl" status || fail "no coordinator"
"$radd" --coordinator="$RADD_COORDINATOR" --name=w --threads=1 \
    --listen=127.0.0.1:0 --cache="$work/cache" 2>>w.log &
all_of twice "$radsubmit" --points=- $opts -af grid.amb "$room" >coord.bin \
    2>stderr || fail "a coordinator: $(cat stderr)"
cmp by1.bin coord.bin || fail "values of a coordinator"
[ "$("$radctl" --json jobs | grep -c '"job"')" -eq 0 ] ||
    fail "jobs are left: $("$radctl" jobs)"
all_of twice "$radsubmit" --points=- $opts -af grid.amb --stats=stats.json \
    "$room" >coord.bin 2>stderr || fail "-af: $(cat stderr)"
awk '/"ambient_values"/ { n += $2 } END { exit n > 20 }' stats.json ||
    fail "-af: $(grep ambient_values stats.json)"
finish
