#!/bin/sh
# raderr.sh - raderr's figures, its pictures, and what it answers to bad input
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
raderr=$top_builddir/raderr

# 2 by 2 grey pixels, flat; three octal mantissas alike, exponent 129
picture()
{
    printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n'
    for m in "$@"; do
        printf "\\$m\\$m\\$m\\201"
    done
}

# expect STATUS MESSAGE ARGUMENTS...
expect()
{
    status=$1 message=$2
    shift 2
    "$raderr" "$@" >out 2>err
    got=$?
    [ $got -eq "$status" ] || fail "raderr $*: exit $got, not $status"
    [ -z "$message" ] || grep -q -- "$message" err ||
        fail "raderr $*: no '$message' in: $(cat err)"
}

picture 200 200 200 200 >ref.hdr
picture 200 200 200 300 >test.hdr

"$raderr" -1 ref.hdr ref.hdr >out || fail "equal pictures"
echo 'mean_ratio 1  nrmse 0  log_rmse 0  p50 0  p95 0  p99.9 0  max 0  maxabs 0' |
    cmp -s - out || fail "equal pictures: $(cat out)"
"$raderr" test.hdr ref.hdr >out || fail "two pictures"
[ "$(wc -l <out)" -eq 8 ] || fail "not eight figures"
# 128.5 and 192.5 steps of 1/128: one of four is 1.498054 times as bright
grep -q '^mean_ratio 1.12451$' out || fail "mean: $(cat out)"
"$raderr" -b 2 -1 test.hdr ref.hdr | grep -q 'nrmse 0.124514 ' ||
    fail "blocks are not averaged"
# a block at an edge that is not whole is left out: 1 by 1 of 3 by 2
wide()
{
    picture "$@" | sed 's/^-Y 2 +X 2$/-Y 2 +X 3/'
}
wide 200 200 77 200 200 77 >wide.hdr
wide 200 200 300 200 200 300 >other.hdr
"$raderr" -b 2 -1 wide.hdr other.hdr | grep -q 'nrmse 0 ' ||
    fail "a part of a block counts"
rm other.hdr
"$raderr" --map=map.png test.hdr ref.hdr >out &&
    "$raderr" --false-colour lum.png ref.hdr || fail "no false colours"
for png in map.png lum.png; do
    [ "$(od -An -c -N4 $png | tr -d ' ')" = '211PNG' ] || fail "$png is no PNG"
done

# 128.5 and 192.5 steps again: their mean is 160.5
"$raderr" --mean=mean.hdr ref.hdr test.hdr &&
    "$raderr" -1 mean.hdr ref.hdr >out || fail "no mean"
grep -q 'maxabs 0.249027' out || fail "mean of two: $(cat out)"
"$raderr" --mean=mean.hdr -d 2 test.hdr && "$raderr" -d 2 -1 test.hdr mean.hdr |
    grep -q 'mean_ratio 1 ' || fail "mean of a block"

expect 0 '' --help
expect 0 '' --version
expect 64 'expected two pictures' ref.hdr
cp ref.hdr ./-ref.hdr
expect 64 "unknown option '-ref.hdr'" -ref.hdr ref.hdr
"$raderr" -b 1 -- -ref.hdr ref.hdr >out 2>&1 || fail "--: $(cat out)"
expect 64 'no picture' --mean=mean.hdr
expect 64 'only one' --mean=mean.hdr --map=map.png ref.hdr
expect 64 "'m.png': --mean writes" --mean=m.png ref.hdr
expect 64 "'m.jpg': that format" --mean=m.jpg ref.hdr
expect 64 "'m.hdr': that format" --map=m.hdr ref.hdr ref.hdr
expect 64 "'m.tif': that format" --false-colour=m.tif ref.hdr
expect 64 'with -d only' --mean=mean.hdr -b 2 ref.hdr
expect 64 'with -d only' --mean=mean.hdr -1 ref.hdr
for option in -1 '-b 2' '-c 2' '-d 2'; do
    # shellcheck disable=SC2086 # options are words
    expect 64 'with --scale only' --false-colour=m.png $option ref.hdr
done
expect 65 'not a multiple' --mean=mean.hdr -d 3 ref.hdr
expect 65 'sizes differ' --mean=other.hdr ref.hdr mean.hdr
expect 64 "'mean.hdr' is one of the pictures" --mean=mean.hdr ref.hdr mean.hdr
expect 64 'unknown' -x ref.hdr ref.hdr
expect 64 "option '-b'" -b 0 ref.hdr ref.hdr
expect 64 "option '-c'" -c abc ref.hdr ref.hdr
expect 64 "option '-c': missing value" ref.hdr ref.hdr -c
expect 64 "option '--map': missing value" ref.hdr ref.hdr --map
expect 65 'not a multiple' -d 3 test.hdr ref.hdr
expect 65 'sizes differ' -d 2 test.hdr ref.hdr
expect 65 'not a Radiance picture' map.png ref.hdr
head -c 50 ref.hdr >short.hdr
expect 65 'short.hdr' short.hdr ref.hdr
picture 0 0 0 0 | tr '\201' '\0' >black.hdr
expect 65 'black' ref.hdr black.hdr
expect 66 'missing.hdr' missing.hdr ref.hdr
expect 73 '' --map=no/such/folder.png test.hdr ref.hdr
finish
