#!/bin/sh
# cluster_backpressure.sh - rows that nobody takes wait, at most so many: then
# who makes them waits, and nothing is dropped
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
. "$top_srcdir/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/faults.sh"
set -u

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
until_true 30 grep -q 'children wait' w1.log || fail "nobody waits"
tell c1 hold up
kib=$(sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$pid_1/status")
[ "$kib" -lt 60000 ] || fail "radd has $kib KiB"
tell c1 well
wait $job || fail "the job: $(cat big.err)"
grep -q 'children go on' w1.log || fail "nobody goes on"
cmp alone.hdr big.hdr || fail "the picture differs"
faulty_stop
finish
