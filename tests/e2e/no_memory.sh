#!/bin/sh
# no_memory.sh - whichever allocation of a program fails, what comes is what would
# have come, or the program says that memory is out and ends with 71
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
radscene=$top_builddir/radscene
raderr=$top_builddir/raderr
shim=$top_builddir/tests/tools/disaster.so
{ [ -e "$shim" ] && ! is_sanitized; } || {
    echo "SKIP: no $shim"
    rm -rf "$work"
    exit 77
}

# a file of the same name lies further on along RAYPATH
mkdir first second
echo 'f = .5;' >first/f.cal
echo 'f = .25;' >second/f.cal
export RAYPATH="$work/first:$work/second"
cat >scene.rad <<'END'
void brightfunc half 2 f f.cal 0 0
half light lamp 0 0 3 8 8 8
lamp sphere a 0 0 4 0 0 .5 .1
half plastic grey 0 0 5 .5 .5 .5 .02 .1
grey bubble b 0 0 4 0 0 0 1
void mist fog 0 0 3 .1 .1 .1
fog sphere c 0 0 4 0 0 -.5 .3
END
printf '0 .2 -.7 0 0 1\n0 .2 .7 0 .1 -1\n' >rays

# out_of PROGRAM OPTION...: with each allocation that fails; its input is `rays`
out_of()
{
    rm -f made.png
    "$@" <rays >calm.out 2>err || fail "$*: $(cat err)"
    cp made.png calm.png 2>/dev/null || : >calm.png
    n=0
    while :; do
        n=$((n + 1))
        rm -f struck made.png
        LD_PRELOAD="$shim" DISASTER=alloc:$n:fail DISASTER_EARLY=yes \
            DISASTER_LOG="$work/struck" "$@" <rays >out 2>err
        status=$?
        [ -e struck ] || break
        [ -e made.png ] || : >made.png
        case $status in
        0)
            cmp -s out calm.out && cmp -s made.png calm.png ||
                fail "$*: other output without allocation $n"
            ;;
        71) grep -q 'out of memory' err || fail "$*: $n: says '$(cat err)'" ;;
        *) fail "$*: $n: status $status, $(cat err)" ;;
        esac
        [ "$failed" -eq 0 ] || finish
    done
    [ $n -gt 20 ] || fail "$*: no allocation fails"
}

out_of "$radscene" check scene.rad
out_of "$radscene" freeze scene.rad
out_of "$radscene" rays -ab 1 -ad 2048 -as 64 -aa 0 scene.rad
"$radsubmit" --local -vf "$scenes/room.vf" -x 16 -y 12 -ab 0 -o a.hdr \
    "$scenes/room.rad" 2>err || fail "a picture: $(cat err)"
"$radctl" key add worker:w1 --keys="$work/keys" >out || fail "a key"
out_of "$radctl" --json key list --keys="$work/keys"
out_of "$raderr" --map made.png a.hdr a.hdr

# daemons of an own cluster, each of which lacks it once when it listens: others go
# on, or what radsubmit says is no bug of ours
for n in 30 100 150 200 400 800; do
    LD_PRELOAD="$shim" DISASTER=alloc:$n:fail "$radsubmit" --local \
        --workers=2 --threads=1 -vf "$scenes/room.vf" -x 16 -y 12 -ab 0 \
        -o b.hdr "$scenes/room.rad" 2>err </dev/null
    case $? in
    0) cmp a.hdr b.hdr || fail "$n: another picture" ;;
    71) grep -q 'out of memory' err || fail "$n: says '$(cat err)'" ;;
    *) fail "$n: $(cat err)" ;;
    esac
done
finish
