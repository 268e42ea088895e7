#!/bin/sh
# submit_error.sh - radsubmit says how far its picture may be off, and is right:
# pictures by other random numbers differ by about as much
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

raderr=$top_builddir/raderr
room=$scenes/room.rad
view="-vf $scenes/room.vf -pa 0 -x 400 -y 300 -pj .9 -dj .5"

estimate() # FILE NAME: in all, or of one part
{
    sed -n "s/^ *\"$2\": \\([0-9.e-]*\\),*\$/\\1/p" "$1" | head -n 1
}

# Two pictures with these options: the error estimated, and that of one seen in
# the other, by blocks of 5x5; the latter has both pictures' noise, and none of
# what they have in common.
look() # OPTIONS
{
    for seed in 1 2; do
        # shellcheck disable=SC2086 # options are words
        "$radsubmit" --local --threads=1 --seed=$seed --stats=$seed.json \
            $view $1 -o $seed.hdr "$room" 2>err || fail "$(cat err)"
    done
    tail -n 1 err | grep -q '^radsubmit: done in [0-9.e-]* s, relative error' ||
        fail "the last line: $(cat err)"
    said=$(estimate 2.json estimate)
    ambient=$(estimate 2.json ambient)
    real=$("$raderr" -1 -c 4 -b 5 1.hdr 2.hdr |
        awk '{ print $6 / sqrt(2) }')
}

look "-ab 1 -aa .3 -ar 32 -ad 32 -as 0"
coarse=$ambient
awk -v a="$said" -v b="$real" 'BEGIN { exit !(a > b / 2 && a < 2 * b) }' ||
    fail "estimated $said, but pictures differ by $real"
grep -A 3 '"error"' 2.json | grep -q '"ambient": 0\.0*[1-9]' ||
    fail "nothing ambient: $(grep -A 3 '"error"' 2.json)"
look "-ab 1 -aa .15 -ar 64 -ad 512 -as 0"
awk -v a="$ambient" -v b="$coarse" 'BEGIN { exit !(a > 0 && a < .5 * b) }' ||
    fail "ambient $coarse, and with a better cache still $ambient"

# Does the picture with -ab 3 tell what it leaves out, and do more bounces bring
# it?
look_beyond() # REFLECTANCE
{
    cat >walls.rad <<EOF
void light lamp 0 0 3 30 30 30
lamp polygon panel 0 0 12 2 2 2.9  2 2.5 2.9  2.5 2.5 2.9  2.5 2 2.9
void plastic paint 0 0 5 $1 0 0
paint bubble room 0 0 4 2 2 1.5 2.5
EOF
    for bounces in 3 20; do
        # shellcheck disable=SC2086 # options are words
        "$radsubmit" --local --threads=1 --stats=$bounces.json $few \
            -ab $bounces -lr 40 -o $bounces.hdr walls.rad 2>$bounces.err ||
            fail "$(cat $bounces.err)"
    done
    said=$(estimate 3.json left_out)
    real=$("$raderr" -1 3.hdr 20.hdr | awk '{ print 1 - $2 }')
    awk -v a="$said" -v b="$real" 'BEGIN { exit !(a > b / 1.5 && a < 1.5 * b) }' ||
        fail "$1: -ab 3 leaves out $real of the light, and $said is told"
}
few="-vp 1 1 1.6 -vd 1 .8 -.1 -vh 80 -vv 60 -x 120 -y 90 -aa .3 -ar 32 -ad 128"

# of red walls' light it is half, of white ones' a fifth
look_beyond ".9 .1 .1"
look_beyond ".7 .7 .7"
grep -q "^radsubmit: done in .* %; -ab 3 leaves out about [0-9.]* % of the " \
    3.err || fail "of what -ab leaves out the last line says: $(cat 3.err)"
! grep -q 'leaves out' 20.err || fail "-ab 20: $(cat 20.err)"

# without indirect light only the sampler is in doubt
look "-ab 0"
grep -A 3 '"error"' 2.json | grep -q '"ambient": 0.0,' ||
    fail "ambient without -ab: $(grep -A 3 '"error"' 2.json)"
[ -n "$said" ] || fail "no estimate without -ab"

# noise averages out in the pixels of a picture that is filtered down
look "-ab 0 -x 133 -y 100 --oversample=3 -ps 1 -dj 1 -dt 0"
awk -v a="$said" -v b="$real" 'BEGIN { exit !(a > b / 1.6 && a < 1.6 * b) }' ||
    fail "filtered: estimated $said, but pictures differ by $real"
finish
