#!/bin/sh
# other_libm.sh - the picture's bytes do not depend on libm's choice of functions
#
# glibc picks sin(), exp() and others by the processor; without AVX2 and FMA it
# takes those of older ones, whose last bits differ.  Where it has no others, or
# is another library, there is nothing to compare.
# A picture's bytes hide most of that, so in a room of its own everything shines
# or reflects by the last bits of where it was hit, or of a function.
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

older="GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"
older="$older,-AVX2_Usable,-FMA_Usable,-FMA4_Usable"

# of libm, by way of awk
bits()
{
    env "$@" awk 'BEGIN { for (i = 0; i < 2000; i++)
        printf "%.17g %.17g %.17g\n", sin(i * .1), exp(-i * .1), log(i + .1) }' |
        cksum
}

[ "$(bits A=)" != "$(bits "$older")" ] || {
    echo "this libm has one set of functions"
    exit 77
}

# check OPTIONS FILE...: in $scenes
check()
{
    options=$1
    shift
    for libm in A= "$older"; do
        # shellcheck disable=SC2086 # options are words
        (cd "$scenes" && env "$libm" "$top_builddir/tests/tools/seqpict" \
            $options -o "$work/out.hdr" "$@") 2>err || fail "$*: $(cat err)"
        LC_ALL=C sed '1,/^$/d' out.hdr >"body.${libm%%=*}"
    done
    cmp body.A body.GLIBC_TUNABLES || fail "$* $options: another picture"
}

cat >last.cal <<'END'
last(x) : .2 + .7 * frac(1e13 * x);
place = last(Px / 3 + Py / 5 + Pz / 7);
f1 = last(sin(3 * Px) + cos(2 * Py) + tan(Pz / 3));
f2 = last(asin(Px / 4) + acos(Py / 4) + atan(Pz) + atan2(Py, Px));
f3 = last(exp(Px) + log(Pz + 1) + log10(Py + 4) + (Pz + 1) ^ 2.3);
END
cat >last.rad <<'END'
void brightfunc place
2 place last.cal
0
0
place light lamp 0 0 3 9 8 7
lamp sphere ball 0 0 4 1.5 -1 2.4 .15
lamp ring disk 0 0 8 -1 1 2.9 0 0 -1 0 .3
lamp cylinder tube 0 0 7 -2 -2 2.5 2 -2.2 2.5 .05
lamp polygon panel 0 0 12 -2 2 2.9 -2 2.6 2.9 -1.2 2.6 2.9 -1.2 2 2.9
place light sky 0 0 3 1 1 1
sky source dome 0 0 4 0 0 1 20
void colorfunc functions
4 f1 f2 f3 last.cal
0
0
functions plastic floor 0 0 5 .7 .7 .7 .1 .15
floor ring ground 0 0 8 0 0 0 0 0 1 0 6
place plastic2 wall 4 1 0 0 . 0 6 .6 .6 .6 .1 .2 .1
wall polygon back 0 0 12 -3 3 0 3 3 0 3 3 3 -3 3 3
wall polygon side 0 0 12 3 -3 0 3 -3 3 3 3 3 3 3 0
place ashik2 coat 4 0 1 0 . 0 8 .5 .5 .5 .3 .3 .3 50 900
coat sphere big 0 0 4 1 1 .8 .7
void dielectric clear 0 0 5 .9 .9 .9 1.5 0
clear sphere drop 0 0 4 -1 0 .7 .5
END
room="-vp -2.6 -2.7 2.6 -vd 1 1 -.75 -vu 0 0 1 -vh 80 -vv 80 -x 48 -y 48"
rays="-ps 2 -pj .67 -dj .5 -ss 1 -st .05"
passes="-ab 2 -aa .25 -ar 32 -ad 64 -as 16 --ambient=passes"
check "$room $rays -ab 0" "$work/last.rad"
check "$room $rays -ab 2 -aa 0 -ad 4" "$work/last.rad"
check "$room $rays $passes" "$work/last.rad"
for name in aniso ashik brdf brdf_data brtd bsdf fprism functions lamps lights \
    phong prism spectra tables wgmd; do
    check "$room $rays -ab 0" brdf_room.rad $name.rad
done
for name in ashik bsdf prism wgmd; do
    check "$room $rays $passes" brdf_room.rad $name.rad
done
check "-vf room.vf -x 72 -y 72 $rays $passes" room.rad
check "-vf room.vf -x 48 -y 48 $rays -ab 1 -aa 0 -ad 4" room.rad
check "-vf room.vf -x 48 -y 48 $rays $passes -av .1 .1 .1 -aw 16" room.rad
for view in v l h c s a; do
    check "-vf room.vf -vt$view -vh 60 -vv 60 -x 48 -y 48 $rays -ab 0" room.rad
done
finish
