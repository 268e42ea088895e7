#!/bin/sh
# cluster_backpressure.sh - rows that nobody takes wait, at most so many: then
# who makes them waits, and nothing is dropped
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/faults.sh"

# 53 MB of rows, soon made: floats, since there are distances
cat >plain.rad <<'EOF'
void glow sky 0 0 4 1 1 1 0
sky source all 0 0 4 0 0 1 360
EOF
view="-vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 60 -vv 60 -x 1900 -y 1750 -ps 1 -ab 0
--partition=window --windows=3 -z far.z"

# shellcheck disable=SC2086 # options are words
"$radsubmit" --local --threads=1 $view -o alone.hdr plain.rad 2>stderr ||
    fail "embedded: $(cat stderr)"

coord_options=--lease-floor-s=600
faulty_start 1 1
# from the first row on, so that it does not matter how soon they are looked at
tell c1 rate 500000
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=big $view -o big.hdr plain.rad \
    2>big.err &
job=$!
until_true 30 grep -q 'child waits' w1.log || fail "nobody waits"
tell c1 hold up
kib=$(sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$pid_1/status")
[ "$kib" -lt 60000 ] || fail "radd has $kib KiB"
tell c1 well
wait $job || fail "the job: $(cat big.err)"
grep -q 'child goes on' w1.log || fail "nobody goes on"
cmp alone.hdr big.hdr || fail "the picture differs"

# rows that wait for a job which is not started yet hold up no other job
large="-vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 60 -vv 60 -x 2300 -y 2100 -ps 1 -ab 0
--partition=window --windows=1 -z large.z"
waits() { [ "$(grep -c 'child waits' w1.log)" -ge "$1" ]; }
before=$(grep -c 'child waits' w1.log)
tell c1 rate 500000
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=large $large -o large.hdr plain.rad \
    2>large.err &
job=$!
until_true 30 waits $((before + 1)) || fail "large: nobody waits"
tell c1 refuse
until_true 30 waits $((before + 2)) || fail "large: nobody waits alone"
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --name=first --priority=5 --wait=300 \
    -vf "$scenes/room.vf" -x 40 -y 30 -ab 0 -o first.hdr "$scenes/room.rad" \
    2>first.err &
first=$!
until_true 30 grep -q '^radsubmit: job' first.err || fail "first: $(cat first.err)"
tell c1 well
until_true 60 gone $first || {
    fail "first waits for what large has kept: $(tail -n 2 w1.log)"
    kill -KILL $first $job
}
wait $first || fail "first: $(cat first.err)"
wait $job || fail "large: $(cat large.err)"
faulty_stop
finish
