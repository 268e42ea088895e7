#!/bin/sh
# submit_tone.sh - what a .png shows: curves, exposure, depth, of stills,
# previews and animations, when they come and when they are fetched; beside
# pfilt and pcond where these are on PATH
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

shown=$top_builddir/tests/tools/shown
room=$scenes/room.rad
still="-vf $scenes/room.vf -x 120 -y 90 -ab 0 -pj 0 --oversample=1"

# near FILE FILE TOLERANCE NAME: numbers, line by line
near()
{
    paste -d ' ' "$1" "$2" | awk -v tol="$3" '
        { if (NF != 6) bad++
          for (i = 1; i <= 3; i++) {
              d = $i - $(i + 3); if (d < 0) d = -d; if (d > most) most = d } }
        END { if (!NR || bad || most > tol) {
              print NR " pixels, " bad + 0 " bad lines, off by " most; exit 1 } }' \
        >why || fail "$4: $(cat why)"
}

# rendered OUTPUT OPTION...
rendered()
{
    out=$1
    shift
    # shellcheck disable=SC2086 # options are words
    "$radsubmit" --local --threads=1 $still "$@" -o "$out" "$room" 2>err ||
        fail "$*: $(cat err)"
}

# --- stills: what the file holds is what the curve makes of the .hdr ---

rendered room.hdr
for tone in photographic linear human; do
    for exposure in auto +1 -.5 .8; do
        "$shown" $tone $exposure room.hdr >curve || fail "shown $tone"
        rendered room.png --tone=$tone --exposure=$exposure --bits=16 \
            --preview=seen.png
        "$shown" room.png >file || fail "no PNG of $tone"
        [ "$(head -n 1 file)" = "120 90 16 0 0.45455" ] ||
            fail "$tone: the file is '$(head -n 1 file)'"
        sed 1d file >pixels
        near curve pixels 4e-5 "$tone, $exposure"
        cmp -s room.png seen.png || fail "$tone: the preview is another picture"
    done
done
rendered room.png
"$shown" photographic auto room.hdr >curve
"$shown" room.png >file
[ "$(head -n 1 file)" = "120 90 8 0 0.45455" ] || fail "$(head -n 1 file)"
sed 1d file >pixels
near curve pixels 5e-3 "the default"
rendered - --format=png --exposure=+1 >piped.png
rendered room.png --exposure=+1
cmp -s room.png piped.png || fail "--format=png is shown in another way"

# other numbers of the same scene look the same
rendered xyz.png -pXYZ --bits=16
rendered room.png --bits=16
"$shown" xyz.png | sed 1d >xyz
"$shown" room.png | sed 1d >rgb
near xyz rgb .06 "-pXYZ" # a step of XYZE in X and Y is more in blue
rendered srgb.png -pc .64 .33 .3 .6 .15 .06 .3127 .329 --bits=16
"$shown" srgb.png | sed 1d >srgb
near srgb rgb 1e-4 "-pc of sRGB's own primaries"
rendered adobe.png -pc .64 .33 .21 .71 .15 .06 .3127 .329 --bits=16
cmp -s adobe.png room.png && fail "-pc changes nothing"

# --- an animation: from the floor to the lamp ---

{
    echo "rvu -vtv -vp 2 1 1.3 -vd .3 1 -.9 -vu 0 0 1 -vh 40 -vv 30"
    echo "rvu -vtv -vp 2 .15 1.3 -vd 0 1 .1 -vu 0 0 1 -vh 75 -vv 60"
} >views
walk="-S 1 --views=views -x 40 -y 30 -ab 0 -av .05 .05 .05 -pj 0 --oversample=1"

# walked PATTERN OPTION...
walked()
{
    out=$1
    shift
    # shellcheck disable=SC2086
    "$radsubmit" --local --threads=1 $walk "$@" -o "$out" "$room" 2>err ||
        fail "walk $*: $(cat err)"
}

# of FILE.png FILE.hdr: light of the screen over radiance, of what is not clipped
of()
{
    "$shown" "$1" | sed 1d >light
    "$shown" linear 1e-6 "$2" >radiance
    paste -d ' ' light radiance | awk '
        $1 < .9 && $2 < .9 && $3 < .9 && $2 > .05 { a += $2; b += $5 * 1e6 }
        END { print(b > 0 ? a / b : 0) }'
}

# ratio A B LOW HIGH NAME
ratio()
{
    awk -v a="$1" -v b="$2" -v low="$3" -v high="$4" 'BEGIN {
        exit !(b > 0 && a / b > low && a / b < high) }' ||
        fail "$5: $1 and $2"
}

walked w%d.hdr
walked w%d.png --tone=linear --bits=16
one=$(of w1.png w1.hdr) two=$(of w2.png w2.hdr)
ratio "$one" "$two" .995 1.005 "frames of one exposure"
walked e%d.png --tone=linear --bits=16 --exposure=each
cmp -s w1.png e1.png || fail "--exposure=each: the first frame changed"
each=$(of e2.png w2.hdr)
ratio "$two" "$each" 1.2 100 "--exposure=each is no other one"
walked e%d.png --tone=linear --bits=16 --exposure=each,-1
ratio "$each" "$(of e2.png w2.hdr)" 1.99 2.01 "--exposure=each,-1"
walked f%d.png --tone=linear --bits=16 --exposure=.25
ratio "$(of f2.png w2.hdr)" .25 .995 1.005 "a factor"

# --- fetched: as when it came ---

export RADD_COORDINATOR="$work/coord.sock"
"$radcoord" --listen= --socket="$RADD_COORDINATOR" --state="$work/state" \
    2>coord.log &
until_true 20 "$radctl" status || fail "no coordinator"
"$radd" --coordinator="$RADD_COORDINATOR" --name=w --threads=1 \
    --listen=127.0.0.1:0 --cache="$work/cache" 2>worker.log &
# shellcheck disable=SC2086
id=$("$radsubmit" --detach $walk "$room" 2>err) || fail "--detach: $(cat err)"
until_true 60 "$radctl" fetch "$id" --frame=2 -o got.hdr || fail "no frame 2"
cmp -s got.hdr w2.hdr || fail "the coordinator's frame is another one"
for tone in photographic linear human; do
    for exposure in auto each +1 .5; do
        walked w%d.png --tone=$tone --exposure=$exposure --bits=16
        "$radctl" fetch "$id" --frame=2 --tone=$tone --exposure=$exposure \
            --bits=16 -o got.png || fail "fetch: $tone, $exposure"
        cmp -s got.png w2.png || fail "fetched one: $tone, $exposure"
    done
    "$radctl" fetch "$id" --tone=$tone --exposure=.5 --bits=16 -o got%d.png ||
        fail "fetch all: $tone"
    cmp -s got2.png w2.png || fail "fetched all: $tone"
done

# --- refusals ---

expect 64 "--tone is for a .png" "tone of .hdr" \
    "$radsubmit" --tone=linear -o x.hdr "$room"
expect 64 "--exposure is for a .png" "exposure of stdout" \
    "$radsubmit" --exposure=+1 "$room"
expect 64 "--bits is for a .png" "bits of --format=hdr" \
    "$radsubmit" --bits=16 --format=hdr -o x.png "$room"
expect 64 "give such options to radctl fetch" "tone of --detach" \
    "$radsubmit" --tone=human --detach "$room"
expect 64 "none of photographic|linear|human" "no tone" \
    "$radsubmit" --tone=reinhard -o x.png "$room"
expect 64 "none of 8|16" "no bits" "$radsubmit" --bits=10 -o x.png "$room"
expect 64 "'+99' is not auto" "too many stops" \
    "$radsubmit" --exposure=+99 -o x.png "$room"
expect 64 "--tone is for fetch with -o FILE.png" "fetch .hdr" \
    "$radctl" fetch "$id" --tone=linear -o x.hdr
expect 64 "--bits goes with fetch" "no fetch" "$radctl" --bits=16 jobs
expect 64 "'--exposure': '0'" "bad factor" \
    "$radctl" fetch "$id" --exposure=0 -o x.png
expect 64 "none of 8|16" "bad bits" \
    "$radctl" fetch "$id" --bits=7 -o x.png
expect 64 "none of photographic" "bad tone" \
    "$radctl" fetch "$id" --tone=x -o x.png
[ ! -e x.png ] && [ ! -e x.hdr ] || fail "a refused picture was written"

# --- beside Radiance's own ---

# within PROGRAM: its picture room.other against `curve`, luminances of what is
# in the screen's range; one step of RGBE is up to .8 %
within()
{
    pvalue -h -H -d room.other >other || fail "pvalue"
    paste -d ' ' other curve | awk -v most="$2" '
        $1 < 1 && $2 < 1 && $3 < 1 && $2 > .005 {
            n++; r = $5 / $2 - 1; s += r; q += r * r }
        END { printf "%d pixels, mean %.4f, rms %.4f\n", n, s / n, sqrt(q / n)
              exit !(n > 1000 && sqrt(q / n) < most) }' >why ||
        fail "beside $1: $(cat why)"
    echo "beside $1: $(cat why)"
}

if command -v pfilt >/dev/null && command -v pvalue >/dev/null; then
    pfilt room.hdr >room.other || fail "pfilt"
    "$shown" linear auto room.hdr >curve
    within pfilt .005
    pfilt -1 -e 3 room.hdr >room.other || fail "pfilt -1 -e"
    "$shown" linear 3 room.hdr >curve
    within "pfilt -1 -e 3" .005
fi
# Where a picture has black pixels pcond's own curve differs by 13 % when the
# picture is turned by 90 degrees, since it samples at random.
if command -v pcond >/dev/null && command -v pvalue >/dev/null; then
    rendered room.hdr -av .05 .05 .05
    pcond -h room.hdr >room.other || fail "pcond"
    "$shown" human auto room.hdr >curve
    within "pcond -h" .03
fi
finish
