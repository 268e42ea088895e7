#!/bin/sh
# rtrace_path.sh - command lines of scripts that call rtrace, with the rtrace of
# --rpict-path
# shellcheck disable=SC2086,SC2016 # options are words, and a $ is rtrace's
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

folder=$("$radsubmit" --rpict-path) || fail "--rpict-path"
[ -x "$folder/rtrace" ] || fail "no rtrace in '$folder'"
PATH=$folder:$PATH
RADD_RTRACE_OPTIONS='--local --threads=1'
export PATH RADD_RTRACE_OPTIONS
[ "$(command -v rtrace)" = "$folder/rtrace" ] || fail "PATH finds another"

# inside of a sphere that shines all is known
cat >box.rad <<'END'
void glow shine 0 0 4 2 2 2 0
shine bubble box 0 0 4 0 0 0 10
END
"$top_builddir/radscene" freeze box.rad >box.oct
printf '0 0 0 0 0 1\n3 0 0 1 0 0\n' >rays

status() # STATUS COMMAND LINE
{
    want=$1
    shift
    sh -c "$*" >out 2>err <rays
    got=$?
    [ $got = "$want" ] || fail "status $got, not $want: $*: $(cat err)"
}
says() # LINE: each number on it is that of the output
{
    tr -s '\t\n' '  ' <out | awk -v want="$1" '
        { n = split(want, w, " ")
          if (n != NF) exit 1
          for (i = 1; i <= n; i++)
              if (($i - w[i]) ^ 2 > 1e-10) exit 1 }' ||
        fail "expected $1, got $(cat out)"
}

status 0 rtrace -h -w- -oL box.oct
says '10 7'
[ ! -s err ] || fail "rtrace says nothing of what goes well: $(cat err)"
# what -ld ends meets nothing, and its end is told
status 0 "printf '1 0 0 0 0 3\n0 0 0 0 12 0\n' | rtrace -h- -ld+ -opL box.oct"
says '1 0 3 1e10 0 10 0 10'
# bifacial_radiance ends lines with returns
status 0 "printf '0 0 0 0 0 1 \r3 0 0 1 0 0 \r' | rtrace -h- -oL box.oct"
says '10 7'
printf '0 0 0 0 0 1 \r3 0 0 1 0 0 \r' >returns
status 0 'rtrace -h- -oL box.oct <returns'
says '10 7'
status 0 rtrace -h- -oL "'!cat box.oct'"
says '10 7'
status 0 rtrace -h- -ov -n 4 box.oct
says '2 2 2 2 2 2'
status 0 rtrace -I -h- -ab 1 -ad 64 -aa 0 -lw 1e-6 box.oct
head -n 1 out | awk '{ exit $1 < 6.2 || $1 > 6.3 }' || fail "pi 2: $(cat out)"
status 0 rtrace -x 1 -y 2 -fac -ab 0 box.oct
LC_ALL=C grep -aqx -- '-Y 2 +X 1' out || fail "no size"
[ "$(tail -c 8 out | od -An -tx1)" = ' 80 80 80 82 80 80 80 82' ] ||
    fail "colours: $(tail -c 8 out | od -An -tx1)"
printf -- '-h-\n-oL\n' >opt
status 0 rtrace @opt box.oct
says '10 7'
status 0 "ROPT='-h- -oL'" rtrace '\$ROPT' box.oct
says '10 7'
status 0 rtrace -pXYZ -ab 0 box.oct
grep -qx 'PRIMARIES= 1.0000 0.0000 0.0000 1.0000 0.0000 0.0000 0.3333 0.3333' \
    out || fail "-pXYZ: the header does not tell: $(cat out)"
status 0 rtrace -h- -pY box.oct
says '358 358'
status 0 rtrace -h- -pXYZ -oLpv -pY -pRGB -pA box.oct
says '10 0 0 10 2 7 10 0 0 2'
status 0 rtrace -pY box.oct
grep -qx NCOMP=1 out && grep -q '^radsubmit .* -pY ' out || fail "-pY: $(cat out)"
status 0 rtrace -h- -cs 4 -co+ box.oct
says '2 2 2 2 2 2 2 2'
echo first >said
status 0 rtrace --progress=always -h- -e said -ov box.oct
[ "$(sed -n 1p said)" = first ] || fail "-e: $(cat said)"
grep -q 'done in' said || fail "-e: $(cat said)"
[ ! -s err ] || fail "-e leaves: $(cat err)"
status 0 rtrace -ab 3 -defaults
grep -qx -- '-ab 3 .*' out || fail "-defaults: $(cat out)"
grep -qx -- '-x 0 .*' out && grep -qx -- '-faa .*' out &&
    ! grep -qE -- '^-(ps|vp) ' out || fail "-defaults of rpict: $(cat out)"
grep -qx -- '-ad 1024 .*' out || fail "-defaults: $(cat out)"
status 0 rtrace -version

# no ray, no value: a script may have none of a kind
: >none
printf '\n \t\n' >blank
for from in 'rtrace -h- box.oct <none' 'rtrace -h- box.oct <blank' \
    'rtrace -h- box.oct </dev/null' 'rtrace -h- box.oct <&-' \
    ': | rtrace -h- box.oct' ': | rtrace -h- -oL box.oct'; do
    status 0 "$from"
    [ ! -s out ] || fail "$from: $(cat out)"
done
status 0 ': | rtrace box.oct'
grep -q '^FORMAT=ascii' out || fail "no header: $(cat out)"
# floats of zeros are rays, though without a direction
head -c 48 /dev/zero >zeros
status 0 'rtrace -h- -ff box.oct <zeros'
[ "$(wc -c <out)" -eq 24 ] || fail "$(wc -c <out) bytes for two rays of zeros"
status 2 'rtrace nothing.oct <none'

# what is refused says so, with rtrace's statuses
refused() # STATUS TEXT OPTIONS...
{
    want=$1 text=$2
    shift 2
    status "$want" rtrace "$@"
    grep -qF -- "$text" err || fail "$*: $(cat err)"
}
refused 1 "missing octree" -h-
refused 1 "box.oct" box.oct box.oct
refused 1 "'-zz'" -zz box.oct
refused 1 "'-P' of rtrace" -P file box.oct
refused 1 "'-ti' of rtrace" -ti shine box.oct
refused 1 "'t' of rtrace" -otv box.oct
refused 1 "--points and -pc" -pc .64 .33 .3 .6 .15 .06 .3127 .329 box.oct
refused 1 "empty output" -o box.oct
refused 1 "'a=1' is an expression" -e "'a=1'" box.oct
[ ! -e 'a=1' ] || fail "a definition is taken for -e's file"
refused 1 "'-f' of rpict" -f a.cal box.oct
refused 1 "'-ap' of rtrace" -ap a.pm 50 box.oct
refused 1 "'-features' of rtrace" -features
refused 1 "'-n'" -n 0 box.oct
refused 1 "'-vp'" -vp 0 0 0 box.oct
refused 1 "'-pM' of rtrace is not supported: -cs 20 -co+" -pM box.oct
refused 1 "-pY asks for one number" -fac -pY box.oct
refused 1 "-pY and -co+ exclude each other" -cs 6 -co+ -pY box.oct
refused 2 "nothing.oct" nothing.oct
echo 1 2 3 >rays
refused 1 "stdin:1: expected six numbers" box.oct

# the options' values are counted right: each of -defaults stands alone, too
printf '0 0 0 0 0 1\n' >rays
"$radsubmit" --points=- -defaults | sed 's/ *#.*//' |
    grep -v -e ^-- -e ^-v -e '^-p[a-z]' -e '^-pXYZ' >all
while read -r line; do
    status 0 rtrace -h- $line box.oct
done <all
# a switch takes no word behind it, however it says on or off
for switch in -I -h -ld -i -u -w -bv -dv -co; do
    for onoff in + 1 y Y t T - 0 n N f F; do
        status 0 rtrace $switch$onoff -defaults
    done
done
status 0 rtrace -oL -hn box.oct
says '10'
check_nothing_left "rtrace"
finish
