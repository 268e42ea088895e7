#!/bin/sh
# submit_false_colour.sh - pictures of luminance with a legend, by radsubmit,
# radctl fetch and raderr: the same
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

raderr=$top_builddir/raderr
cp "$scenes/room.rad" room.rad
cp "$scenes/room.vf" v.vf
small="-vf v.vf -x 60 -y 45 --oversample=1"
render="$radsubmit --local --workers=1 --threads=1 $small"

# shellcheck disable=SC2086 # options are words
{
    $render -o a.hdr room.rad 2>stderr || fail "$(cat stderr)"
    $render --false-colour -o a.png room.rad 2>stderr || fail "$(cat stderr)"
    $render --false-colour=20,contour=lines -o b.png --preview=p.png room.rad \
        2>stderr || fail "$(cat stderr)"
    $render -i --false-colour=500,log=2 -o i.png room.rad 2>stderr ||
        fail "$(cat stderr)"
    $render -i -o i.hdr room.rad 2>stderr || fail "$(cat stderr)"
}
"$raderr" --false-colour=a2.png a.hdr || fail "raderr"
cmp a.png a2.png || fail "raderr shows it otherwise"
"$raderr" --false-colour b2.png --scale=20,contour=lines a.hdr || fail "raderr"
cmp b.png b2.png || fail "raderr has other contours"
cmp b.png p.png || fail "the last preview is not the picture"
cmp -s a.png b.png && fail "a scale changes nothing"
"$raderr" --false-colour i2.png --scale=500,log=2 i.hdr || fail "raderr"
cmp i.png i2.png || fail "raderr shows illuminance otherwise"
"$raderr" --false-colour i3.png --scale=500,log=2,label=lux i.hdr ||
    fail "raderr"
cmp i.png i3.png || fail "illuminance is not in lux"

# one scale for a walk
printf 'rview -vp 1 1 1 -vd 1 0 0\nrview -vp 1 1 1 -vd 0 1 0\n' >walk.vf
cluster_start 1 1
# shellcheck disable=SC2086
{
    "$radsubmit" --coordinator="$sock" -S 1 --views=walk.vf $small \
        --false-colour -o f%d.png room.rad 2>stderr || fail "$(cat stderr)"
    id=$("$radsubmit" --coordinator="$sock" -S 1 --views=walk.vf $small \
        --detach room.rad) || fail "--detach"
}
until "$radctl" --coordinator="$sock" fetch "$id" --false-colour -o g%d.png \
    2>stderr; do
    [ $? -eq 75 ] || { fail "fetch: $(cat stderr)"; break; }
    sleep .1
done
cmp f1.png g1.png && cmp f2.png g2.png ||
    fail "fetch shows them otherwise"
"$radctl" --coordinator="$sock" fetch "$id" --frame=2 --false-colour -o h.png ||
    fail "fetch of one frame"
cmp f2.png h.png || fail "a frame alone has a scale of its own"

# shellcheck disable=SC2086
{
    expect 64 "--tone is no matter of --false-colour" "with a tone" \
        $render --false-colour --tone=human -o x.png room.rad
    expect 64 "--false-colour is for a .png" "no .png" \
        $render --false-colour -o x.hdr room.rad
    expect 64 "option '--false-colour': 'n=0' is no part of a scale" \
        "a bad scale" $render --false-colour=10,n=0 -o x.png room.rad
}
expect 64 "--scale is for --false-colour" "a scale alone" \
    "$raderr" --scale=10 a.hdr a.hdr
expect 64 "is no part of a scale" "raderr's scale" \
    "$raderr" --false-colour=x.png --scale=ten a.hdr
[ "$(wc -l <stderr)" = 1 ] || fail "more than a line: $(cat stderr)"
expect 64 "option '--false-colour': empty value" "no name" \
    "$raderr" --false-colour= a.hdr
expect 64 "expected two pictures, got 0; see raderr --help" "no picture" \
    "$raderr"
finish
