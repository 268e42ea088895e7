#!/bin/sh
# submit_oversample.sh - --oversample renders a larger picture and filters it
# down, to the same bytes however it was shared; its header, size, distances,
# statistics and prediction are those of what is written
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

room=$scenes/room.rad
view="-vf $scenes/room.vf"
size="-x 61 -y 45"
plain="-ab 0 -ps 4"

same() # WHAT A B
{
    body "$2" >"$2.body"
    body "$3" >"$3.body"
    cmp -s "$2.body" "$3.body" || fail "$1: another picture"
}

number() # NAME FILE: the first of that name
{
    sed -n "s/^ *\"$1\": \([0-9.eE+-]*\),\{0,1\}\$/\1/p" "$2" | head -n 1
}

# submit OUT OPTION...: on a cluster of its own
submit()
{
    out=$1
    shift
    # shellcheck disable=SC2086 # options are words
    "$radsubmit" --local $view $size $plain "$@" -o "$out" "$room" 2>err ||
        fail "$*: $(cat err)"
}

# alone OUT OPTION...: one thread, without a cluster
alone()
{
    out=$1
    shift
    # shellcheck disable=SC2086
    "$top_builddir/tests/tools/seqpict" $view $size $plain "$@" -o "$out" \
        "$room" 2>err || fail "$*: $(cat err)"
}

# --- whoever renders it ---

for more in --oversample=2 "--oversample=3 --clamp=4"; do
    # shellcheck disable=SC2086
    alone ref.hdr $more -z ref.z
    for partition in static scanbar auto; do
        # shellcheck disable=SC2086
        submit out.hdr $more --partition=$partition --workers=2 -z out.z
        same "$more $partition -z" ref.hdr out.hdr
        cmp -s ref.z out.z || fail "$more $partition: other distances"
    done
done
alone ref.hdr --oversample=2
submit out.hdr --oversample=2 --stats=out.json
same "coded rows" ref.hdr out.hdr
submit few.hdr --oversample=2 --partition=window --windows=5
submit many.hdr --oversample=2 --partition=window --windows=5 --workers=3
same "windows" few.hdr many.hdr

# --- what it says of itself ---

is=$(LC_ALL=C sed -n '/^-Y/{p;q;}' out.hdr)
[ "$is" = "-Y 45 +X 60" ] || fail "its size is $is"
line=$(LC_ALL=C sed -n '/^radsubmit /{p;q;}' out.hdr)
case $line in
"radsubmit --oversample=2 -x 61 -y 45 "*) ;;
*) fail "the header says $line" ;;
esac
LC_ALL=C grep -aq '^VIEW= -vtv .*-vh 75 ' out.hdr || fail "no view"
LC_ALL=C grep -aq '^PIXASPECT' out.hdr && fail "pixels that are not square"
[ "$(number width out.json) $(number height out.json)" = "60 45" ] ||
    fail "the statistics have another size"
[ "$(number oversample out.json)" = 2 ] || fail "no oversample in them"
grep -q '"options": "--oversample=2 -x 61 ' out.json || fail "other options"
# units are of samples
[ "$(sed -n '/"units"/,$s/^.*"width": \([0-9]*\),.*/\1/p' out.json |
    sort -n | tail -n 1)" = 120 ] || fail "units are not 120 samples wide"

# what lines cost is of samples, too
submit again.hdr --oversample=2 --partition=static --workers=2 \
    --estimate=out.json
same "costs of a former run" ref.hdr again.hdr
expect 65 "statistics of 120 by 90 pixels, not 60 by 45" "other samples" \
    "$radsubmit" --local -vf "$scenes/room.vf" -x 61 -y 45 -ab 0 -ps 4 \
    --partition=static --estimate=out.json -o no.hdr "$room"

# a row less than twice as many
# shellcheck disable=SC2086
"$radsubmit" --local $view -vv 30 -x 40 -y 40 -ab 0 --oversample=2 -o low.hdr \
    "$room" 2>err || fail "$(cat err)"
LC_ALL=C sed -n '/^-Y/{p;q;}' low.hdr >sizes
read -r _ rows _ columns <sizes
[ "$columns" = 40 ] || fail "$columns columns"
# shellcheck disable=SC2086
"$radsubmit" --local $view -vv 30 -x 80 -y 80 -ab 0 -o high.hdr "$room" 2>err
LC_ALL=C sed -n '/^-Y/{p;q;}' high.hdr >sizes
read -r _ tall _ <sizes
[ "$rows" = $(((tall + 1) / 2)) ] || fail "$rows rows, of $tall"

# the larger picture through Radiance's own program
if command -v pfilt >/dev/null && command -v pvalue >/dev/null; then
    for n in 2 3 5; do
        # shellcheck disable=SC2086
        submit ours.hdr --oversample=$n
        # shellcheck disable=SC2086
        "$radsubmit" --local $view -x $((61 * n)) -y $((45 * n)) $plain \
            -o large.hdr "$room" 2>err || fail "$(cat err)"
        pfilt -1 -x /$n -y /$n -r .6 large.hdr >pfilt.hdr
        for f in ours pfilt; do
            pvalue -h -H -df $f.hdr | od -An -v -t f4 -w12 >$f.values
        done
        # one step of RGBE is 1/128 of the largest component at most
        paste -d ' ' ours.values pfilt.values | awk 'NF == 6 {
            for (most = k = 0; ++k <= 6;) if ($k > most) most = $k
            for (k = 0; ++k <= 3;) {
                d = $k - $(k + 3); d = d < 0 ? -d : d
                if (d > most / 128 + 1e-30) bad++ }
            n++
        } END { exit !(n == 60 * 45 && bad == 0) }' ||
            fail "--oversample=$n is not what pfilt makes of it"
        [ "$(vwright vd <ours.hdr 2>/dev/null)" = \
            "$(vwright vd <pfilt.hdr 2>/dev/null)" ] || fail "another view"
    done
else
    echo "pfilt is not here: not compared with it"
fi

# --- on a screen ---

# a lamp 1000 times as bright as white, which a slanted line cuts so that it is
# before half of the picture: half of the screen's light is there
cat >half.rad <<'EOF'
void light lamp 0 0 3 1000 1000 1000
lamp polygon half 0 0 12 -9 -9 0  9 -9 0  9 .3 0  -9 -.3 0
EOF
cut="-vtl -vp 0 0 1 -vd 0 0 -1 -vu 0 1 0 -vh 2 -vv 2 -x 60 -y 60 -ab 0 -ps 1"
for n in 2 3; do
    # shellcheck disable=SC2086
    "$radsubmit" --local $cut --oversample=$n --tone=linear --exposure=1 \
        -o half.png --preview=half-too.png half.rad 2>err ||
        fail "$(cat err)"
    for f in half half-too; do
        "$top_builddir/tests/tools/shown" $f.png |
            awk 'NR > 1 { sum += $1 } END { print sum / (NR - 1) }' >mean
        awk '{ exit !($1 > .497 && $1 < .503) }' mean ||
            fail "--oversample=$n, $f.png: half of it shows $(cat mean)"
    done
done

# --- a view all around, animations, previews ---

all="-vtc -vp 2 1.5 1.3 -vd 0 1 0 -vu 0 0 1 -vh 360 -vv 60 -x 60 -y 60"
# shellcheck disable=SC2086
"$radsubmit" --local $all -ab 0 -ps 1 -pj 0 -dj 0 --oversample=2 -o around.hdr \
    "$room" 2>err || fail "$(cat err)"
[ -s around.hdr ] || fail "no view all around"

printf 'VIEW= -vp %s\n' "2 .15 1.3" "2 .3 1.3" "2.2 .3 1.3" >views
submit 'walk%d.hdr' --oversample=2 -S 1 --views=views --workers=2 \
    --preview=so.png
for k in 1 2 3; do
    where=$(sed -n "${k}s/VIEW= //p" views)
    # shellcheck disable=SC2086
    alone "ref$k.hdr" $where --frame=$k --oversample=2
    same "frame $k" "ref$k.hdr" "walk$k.hdr"
done
[ -s so.png ] || fail "no preview"

# --- a coordinator that comes back; one who comes for it later ---

cluster_start 2 1
slow="-x 240 -y 240 -ab 1 -aa 0 -ad 6 -ps 1 --oversample=2 --clamp=5"
# shellcheck disable=SC2086
"$top_builddir/tests/tools/seqpict" $view $slow -o large-ref.hdr "$room" \
    2>err || fail "$(cat err)"
rows_come()
{
    "$radctl" --coordinator="$sock" --json job "$id" >job.json &&
        grep -q '"done": 0*\.*0*[1-9]' job.json
}
for _ in 1 2 3 4 5 6 7 8; do # on a busy machine one may be over before it is seen
    # shellcheck disable=SC2086
    id=$("$radsubmit" --coordinator="$sock" --detach $view $slow "$room" 2>err) ||
        fail "$(cat err)"
    until_true 30 rows_come || fail "no rows come"
    grep -q '"state": "done"' job.json || break
done
kill -KILL "$coord_pid"
wait "$coord_pid" 2>/dev/null
grep -q '"state": "done"' job.json && fail "it was over before the accident"
coord_again
got()
{
    "$radctl" --coordinator="$sock" fetch "$id" -o fetched.hdr
}
until_true 60 got || fail "the picture does not come: $(cat c.log)"
same "after a restart" large-ref.hdr fetched.hdr
"$radctl" --coordinator="$sock" --json job "$id" >job.json
grep -q '"oversample": 2' job.json || fail "radctl job does not tell"
[ "$(number width job.json)" = "$(sed -n 's/^-Y .*+X //p;' fetched.hdr |
    head -n 1)" ] || fail "radctl job has another width"
cluster_stop

# --- what is predicted ---

# shellcheck disable=SC2086
"$radsubmit" --dry-run --oversample=3 --stats=dry.json $view $size $plain \
    "$room" >said 2>err || fail "--dry-run: $(cat err)"
grep -q '^picture  60 x 45 of 3 x 3 samples a pixel$' said ||
    fail "--dry-run: $(cat said)"
[ "$(number width dry.json) $(number oversample dry.json)" = "60 3" ] ||
    fail "--dry-run has another picture"
submit three.hdr --oversample=3 --stats=real.json
a=$(number primary_rays dry.json)
b=$(number primary_rays real.json)
awk -v a="$a" -v b="$b" 'BEGIN { exit !(a > b / 1.5 && a < b * 1.5) }' ||
    fail "$a primary rays were predicted, $b came"

# --- what is refused, before anybody is called ---

refused() # TEXT OPTION...
{
    text=$1
    shift
    expect 64 "$text" "$*" "$radsubmit" --coordinator="$work/none.sock" \
        --wait=0 "$@" -o no.hdr "$room"
}
for n in 0 -1 9 2.5 two ''; do
    refused "'--oversample'" --oversample="$n"
done
for n in 0 .5 1001 nan much; do
    refused "'--clamp'" --oversample=2 --clamp="$n"
done
refused "--clamp is for the samples of --oversample" --clamp=4
refused "--clamp is for the samples of --oversample" --clamp=4 --oversample=1
refused "at most 65520 by 65535 are allowed" -x 65521 -y 9 -pa 0 --dry-run
refused "at most 65520 by 65535 are allowed" -x 40000 -y 40000 --oversample=2
refused "too large with --oversample=8: at most 131072" -x 200000 -y 10 \
    --oversample=8
finish
