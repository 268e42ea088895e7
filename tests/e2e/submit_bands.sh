#!/bin/sh
# submit_bands.sh - pictures of more than three bands: spectra and colours of
# known light, the same whoever renders; one job where the scene has no spectra;
# what does not go with them; jobs of all planes cancelled together
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

# a room whose lamps have a spectrum, and one that knows colours alone
room=$work/spectral.rad
sed 's/^void light/void spectrum s 0 0 6 380 780 .7 .8 .9 1\ns light/' \
    "$scenes/room.rad" >"$room"
plain=$scenes/room.rad
view="-vf $scenes/room.vf -x 40 -y 30"

# Light all around of a known spectrum, dark above 700 nm.
cat >glow.rad <<'END'
void spectrum s 0 0 12 400 760 10 9 8 7 6 5 4 3 0 0
s glow g 0 0 4 1 1 1 0
g source all 0 0 4 0 0 1 360
END

# pixels FILE N: the last N bytes of a file as numbers, one a line
pixels()
{
    tail -c "$2" "$1" | od -An -v -tu1 -w1 | tr -d ' '
}

"$radsubmit" --local -cs 10 -x 6 -y 6 -o glow.hsr glow.rad 2>stderr ||
    fail "glow.hsr: $(cat stderr)"
grep -c 'job [0-9a-f]*, plane [1-4] of 4' stderr | grep -qx 4 ||
    fail "no four planes: $(cat stderr)"
for line in 'NCOMP=10' 'WAVELENGTH_SPLITS= 780 588 480 380' \
    'FORMAT=Radiance_spectra' '-Y 6 +X 6'; do
    grep -aqxF -e "$line" glow.hsr ||
        fail "glow.hsr: no line '$line'"
done
# 0 0 3 4 ... 10, of 16: 16 steps each, and half of one which the reader adds
[ "$(pixels glow.hsr 11 | tr '\n' ' ')" = \
    '0 0 48 64 80 96 112 128 144 160 132 ' ] ||
    fail "glow.hsr holds other light: $(pixels glow.hsr 11 | tr '\n' ' ')"
[ "$(pixels glow.hsr 396 | sort -n | uniq -c | wc -l)" -eq 10 ] ||
    fail "glow.hsr: pixels differ"

# As a pattern, it is that light again.
cat >again.rad <<'END'
void specpict p 5 noop glow.hsr . 0 0
0
0
p glow g 0 0 4 1 1 1 0
g source all 0 0 4 0 0 1 360
END
printf 'noop(v,w) = v;\n' >pic.cal
sed -i 's/glow.hsr \./glow.hsr pic.cal/' again.rad
for scene in glow again; do
    echo 0 0 0 0 0 1 | "$top_builddir/radscene" rays -cs 10 -co+ $scene.rad \
        >$scene.bands || fail "rays of $scene.rad"
done
paste -d' ' glow.bands again.bands | awk '
    { for (i = 1; i <= 10; i++)
        if ($i - $(i + 10) > .04 || $(i + 10) - $i > .04) exit 1 }
    NF != 20 { exit 1 }' || fail "glow.hsr as a pattern: $(cat again.bands)"

# What is wrong in the scene is told of all planes: a function's faults at the
# end, together, and bad pixels when their plane ends.
cat >wrong.rad <<'END'
void spectrum unused 0 0 5 380 780 1 1 1
void brightfunc half 2 'if(Px,log(0),1)' . 0 0
half glow h 0 0 4 1 1 1 0
h polygon seen 0 0 12 -9 5 -9 9 5 -9 9 5 9 -9 5 9
void glow hot 0 0 4 1e39 1e39 1e39 0
hot polygon p 0 0 12 .5 4 1 2.5 4 1 2.5 4 2 .5 4 2
END
"$radsubmit" --local -cs 6 -vp 0 0 0 -vd 0 1 0 -vh 45 -vv 45 -x 20 -y 20 \
    -ps 1 -pj 0 -o wrong.hsr wrong.rad 2>stderr || fail "wrong.rad: $(cat stderr)"
places=$(sed -n "s/.* no value in \([0-9]*\) places.*/\1/p" stderr)
hot=$(sed -n 's/.*: \([0-9]*\) pixels have radiance that is negative .*/\1/p' \
    stderr | tr '\n' ' ')
bad=${hot%% *}
[ "$hot" = "$bad $bad " ] || fail "bad pixels of two planes: $(cat stderr)"
[ "$places" = $((2 * (200 - bad))) ] ||
    fail "faults of two planes: $(cat stderr)"

# In colours, and for a screen: what rays see with the same bands.
echo 0 0 0 0 0 1 | "$top_builddir/radscene" rays -cs 10 glow.rad >colour
"$radsubmit" --local -cs 10 -x 6 -y 6 -o glow.hdr glow.rad 2>stderr ||
    fail "glow.hdr: $(cat stderr)"
"$radsubmit" --local -cs 10 -x 6 -y 6 -o glow.png glow.rad 2>stderr ||
    fail "glow.png: $(cat stderr)"
read -r red green blue <colour
printf 'void glow g 0 0 4 %s %s %s 0 g source s 0 0 4 0 0 1 360\n' \
    "$red" "$green" "$blue" >three.rad
"$radsubmit" --local -x 6 -y 6 -o three.hdr three.rad 2>stderr
"$top_builddir/raderr" glow.hdr three.hdr >figures || fail "raderr"
awk '$1 == "max" && $2 < .01 { ok = 1 } END { exit !ok }' figures ||
    fail "glow.hdr: $(cat figures)"

# A plane has no light at all in a scene that shines at one wavelength, with
# all that draws and divides by brightness.
sed 's/^void light/void spectrum line 0 0 6 640 700 0 0 1 0\nline light/' \
    "$plain" >line.rad
# shellcheck disable=SC2086
"$radsubmit" --local $view -cs 20 -ab 2 -ad 32 -as 16 -lr -4 -lw .01 -dt .1 \
    -o line.hsr line.rad 2>stderr || fail "line.hsr: $(cat stderr)"
! grep -q 'no number' stderr || fail "line.hsr: $(cat stderr)"
pixels line.hsr $((40 * 30 * 21)) | awk '
    NR % 21 >= 1 && NR % 21 <= 20 {
        band = NR % 21
        lit[band] += $1 > 0
    }
    # 680 nm is on the edge of bands 5 and 6, counted from 780 down
    END { for (b = 1; b <= 20; b++)
            if ((lit[b] > 0) != (b == 5 || b == 6)) exit 1 }' ||
    fail "line.hsr: light in other bands"

# Without spectra one job renders red, green and blue: each band is one of them.
# shellcheck disable=SC2086
"$radsubmit" --local $view -cs 6 -ab 1 -ad 64 -o plain.hsr "$plain" 2>stderr ||
    fail "plain.hsr: $(cat stderr)"
[ "$(grep -c 'job [0-9a-f]*$' stderr)" -eq 1 ] && ! grep -q plane stderr ||
    fail "more than one job without spectra: $(cat stderr)"
grep -aq -e ' -cs 6 -cw 380 780 -co+ ' plain.hsr || fail "plain.hsr: options"
tail -c $((40 * 30 * 7)) plain.hsr | od -An -v -tu1 -w7 | awk '
    $1 != $2 || $2 != $3 || $4 != $5 { exit 1 }
    $3 != $4 && $5 != $6 { ok++ }
    END { exit !(NR == 1200 && ok > 600) }' || fail "plain.hsr: other bands"
# and what several jobs cannot have this one has, as any job
# shellcheck disable=SC2086
"$radsubmit" --local $view -cs 6 -ab 1 -ad 64 --preview=plain.png \
    -af plain.amb --stats=plain.json -o again.hsr "$plain" 2>stderr ||
    fail "-af and --preview without spectra: $(cat stderr)"
cmp plain.hsr again.hsr || fail "-af and --preview change a picture"
# shellcheck disable=SC2086
"$radsubmit" --local $view -cs 6 -ab 1 -ad 64 --oversample=1 -o shown.png \
    "$plain" 2>stderr || fail "shown.png: $(cat stderr)"
cmp plain.png shown.png || fail "a preview of spectra is not in their colours"
# shellcheck disable=SC2086
"$radsubmit" --local $view -cs 6 -ab 1 -ad 64 --estimate=plain.json \
    -o again.hsr "$plain" 2>stderr || fail "--estimate: $(cat stderr)"
cmp plain.hsr again.hsr || fail "--estimate=FILE changes a picture"
# shellcheck disable=SC2086
"$radsubmit" --local $view -cs 6 -ab 1 --error=20 --stats=goal.json \
    -o again.hsr "$plain" 2>stderr || fail "--error: $(cat stderr)"
grep -q 'estimated error .* 20 % were asked for' stderr ||
    fail "--error says: $(cat stderr)"
grep -q '"goal": ' goal.json || fail "--error is not in the statistics"
# its ambient values are a colour picture's, and those of any bands
for bands in "" "-cs 20"; do
    # shellcheck disable=SC2086
    "$radsubmit" --local $view $bands -ab 1 -ad 64 -af plain.amb -o x.hdr \
        "$plain" 2>stderr || fail "-af of bands with '$bands': $(cat stderr)"
done
for n in 1 2 3; do
    # shellcheck disable=SC2086
    "$radsubmit" --local $view -ab 1 -ad 64 -af three.amb -o x.hdr "$plain" \
        2>stderr || fail "-af $n: $(cat stderr)"
done
cmp plain.amb three.amb || fail "bands of colours have other ambient values"
echo 1 1 1 0 1 0 | "$top_builddir/radscene" rays "$plain" >three
echo 1 1 1 0 1 0 | "$top_builddir/radscene" rays -cs 6 -co+ "$plain" >six
awk '{ print $1, $1, $1, $2, $2, $3 }' three | cmp - six ||
    fail "rays in bands: $(cat six), in colours: $(cat three)"

# The same bytes from one worker and from two, with indirect light.
for n in 1 2; do
    # shellcheck disable=SC2086
    "$radsubmit" --local --workers=$n --threads=$n $view -cs 6 -ab 1 -ad 64 \
        -z room$n.zbf --stats=room$n.json -o room$n.hsr "$room" 2>stderr ||
        fail "room$n.hsr: $(cat stderr)"
done
cmp room1.hsr room2.hsr || fail "room.hsr depends on the workers"
cmp room1.zbf room2.zbf || fail "room.zbf depends on the workers"
python3 -c 'import json
assert len(json.load(open("room1.json"))["planes"]) == 2' ||
    fail "statistics of two planes"

# --- raderr sees the colours of spectra ---

# shellcheck disable=SC2086
"$radsubmit" --local $view -cs 6 -ab 1 -ad 64 -o room1.hdr "$room" 2>stderr ||
    fail "room1.hdr: $(cat stderr)"
"$top_builddir/raderr" room1.hsr room1.hdr >seen || fail "raderr of spectra"
awk '$1 == "mean_ratio" { r = $2 } $1 == "nrmse" { e = $2 }
    END { exit !(r > .995 && r < 1.005 && e < .01) }' seen ||
    fail "colours of spectra: $(cat seen)"

# --- a trial, and sensor points ---

"$radsubmit" --local -cs 6 --dry-run -ab 1 -ad 64 -o x.hdr "$room" >dry 2>stderr ||
    fail "--dry-run: $(cat stderr)"
grep -q '^rays ' dry || fail "--dry-run says: $(cat dry)"
awk 'BEGIN { for (i = 0; i < 50; i++)
    printf "%g %g .8 0 0 1\n", .2 + i % 10 / 3, .2 + int(i / 10) / 2 }' >points
opts='-I -ab 0 -dt 0 -dj 0 -cs 8'
for co in -co+ -co- '--plane 1'; do
    # shellcheck disable=SC2086
    "$radsubmit" --local --threads=1 --points=points -h- $opts $co "$room" \
        >values 2>stderr || fail "points $co: $(cat stderr)"
    # shellcheck disable=SC2086
    "$top_builddir/radscene" rays $opts $co -dc .75 -ds .2 -dr 2 -lw 1e-4 \
        -lr -10 "$room" <points >rays || fail "rays $co"
    paste values rays | awk -v n="$([ "$co" = -co+ ] && echo 8 || echo 3)" '
        { if (NF != 2 * n) exit 1
          for (i = 1; i <= n; i++)
              if (($i - $(n + i))^2 > (1e-5 * $i)^2 + 1e-20) exit 1 }' ||
        fail "sensor points in bands, $co"
done
# shellcheck disable=SC2002,SC2086 # cat makes a pipe
cat points | "$radsubmit" --local --points=- $opts -co+ "$room" >values \
    2>stderr || fail "points on a pipe: $(cat stderr)"
grep -q '^radsubmit .* -cs 8 -cw 380 780 --seed=.* -co+$' values ||
    fail "the header names a plane: $(grep -a '^radsubmit' values)"
grep -qx 'NCOMP=8' values || fail "no NCOMP"
grep -qx 'WAVELENGTH_SPLITS= 780 588 480 380' values || fail "no splits"
[ "$(sed '1,/^$/d' values | wc -l)" -eq 50 ] || fail "points on a pipe"
# the values are those of all planes, so their header names none
cp values all.values
# shellcheck disable=SC2086
"$radsubmit" --local --points=points $opts "$plain" >plain.values 2>stderr ||
    fail "points without spectra: $(cat stderr)"
for file in all plain; do
    grep -q ' -cs 8 -cw 380 780 --seed=' $file.values ||
        fail "$file.values: $(sed '/^$/q' $file.values)"
done
# X, Y and Z are those of green that Radiance's primaries cannot show
cat >green.rad <<'END'
void spectrum green
0
0
7 460 560 0 0 1 0 0
green glow shine
0
0
4 2 2 2 0
shine bubble box 0 0 4 0 0 0 10
END
echo 0 0 0 0 0 1 >ray
"$radsubmit" --local --points=ray -h- -cs 20 -pXYZ green.rad >values 2>stderr ||
    fail "-pXYZ: $(cat stderr)"
awk '{ exit !($2 > 1 && $1 < .1 * $2 && $3 < .4 * $2) }' values ||
    fail "-pXYZ of green: $(cat values)"
# and with -fac a pixel is that of a hyperspectral picture
"$radsubmit" --local --points=ray -cs 20 -co+ -fac -x 1 -y 1 green.rad >values \
    2>stderr || fail "-fac -co+: $(cat stderr)"
LC_ALL=C grep -aqx FORMAT=Radiance_spectra values || fail "-fac -co+: format"
"$top_builddir/raderr" values values >stderr 2>&1 || fail "$(cat stderr)"
[ "$(tail -c 21 values | od -An -v -tu1 -w21 | tr -s ' ')" = \
    ' 0 0 0 0 0 0 0 0 0 0 0 0 16 128 16 0 0 0 0 0 130' ] ||
    fail "-fac -co+: $(tail -c 21 values | od -An -v -tu1 -w21)"

# --- what does not go with it where the scene has spectra ---

line=$(grep -n '^void spectrum' "$room" | sed 's/:.*//')

for option in --error=2 --time=9 --preview=p.png '-af x.amb' --estimate=plain.json; do
    name=$(echo "$option" | sed 's/[= ].*//;s/estimate/&=FILE/')
    # shellcheck disable=SC2086 # an option and its value
    expect 64 "spectral.rad:$line: spectrum 's': -cs above 3 and $name exclude" \
        "$option" "$radsubmit" --local $view -cs 6 -ab 1 $option -o x.hdr "$room"
done
expect 64 "-cs above 3 and -pc exclude each other" "-pc" "$radsubmit" --local -cs 6 \
    -pc .7 .3 .2 .7 .1 .1 .3 .3 -o x.hdr "$room"
expect 64 "spectra have more than three bands" ".hsr" "$radsubmit" --local \
    -o x.hsr "$room"
expect 64 "-co- asks for none" "-co-" "$radsubmit" --local -cs 6 -co- \
    -o x.hsr "$room"
expect 64 "a .png has no spectra" "-co+" "$radsubmit" --local -cs 6 -co+ \
    -o x.png "$room"
expect 64 "exclude each other" "-pXYZ" "$radsubmit" --local -cs 6 -co+ -pXYZ \
    -o x.hsr "$room"
expect 64 "show no colours" "-cw" "$radsubmit" --local -cs 6 -cw 500 600 \
    -o x.hdr "$room"
expect 64 "a range is 50 nm" "-cw" "$radsubmit" --local -cs 6 -cw 500 540 \
    -co+ -o x.hsr "$room"
expect 64 "the scene has spectra" "--plane 8" "$radsubmit" --local -cs 6 \
    --plane 8 -o x.hsr "$room"
expect 64 "three channels" "rays -af" "$top_builddir/radscene" rays -cs 6 \
    -ab 1 -af x.amb "$room"

# --- all planes end together ---

sock=$work/coord.sock
"$radcoord" --listen= --socket="$sock" --state="$work/state" 2>>coord.log &
export RADD_COORDINATOR="$sock"
until_true 20 "$radctl" status || fail "no coordinator"
"$radd" --coordinator="$sock" --name=ws1 --threads=1 \
    --listen=127.0.0.1:0 --cache="$work/cache" 2>>ws1.log &
interruptible "$radsubmit" -vf "$scenes/room.vf" \
    -cs 9 -x 3000 -y 2250 -ps 1 -ds .02 -dj 1 -o big.hsr "$room" 2>big.err &
pid=$!
until_true 30 grep -q 'plane 3 of 3' big.err || fail "no planes: $(cat big.err)"
kill -INT $pid
wait $pid
status=$?
[ $status -eq 75 ] || fail "interrupted: exit status $status: $(cat big.err)"
"$radctl" jobs >jobs
[ "$(grep -c cancelled jobs)" -eq 3 ] || fail "not all cancelled: $(cat jobs)"
grep -q 'plane 2 of 3' jobs || fail "jobs have no plane's name: $(cat jobs)"
[ ! -e big.hsr ] || fail "a picture that was cancelled is there"

# what came to a coordinator of somebody else's comes whole, too
# shellcheck disable=SC2086
"$radsubmit" $view -cs 6 -ab 1 -ad 64 -z far.zbf -o far.hsr "$room" 2>far.err ||
    fail "far.hsr: $(cat far.err)"
cmp room1.hsr far.hsr || fail "far.hsr is another picture"
ids=$(sed -n 's/radsubmit: job \([0-9a-f]*\), plane.*/\1/p' far.err)
# shellcheck disable=SC2086
"$radctl" fetch -o again.hsr $ids || fail "fetch of all planes"
cmp far.hsr again.hsr || fail "radctl fetch makes another picture"
# shellcheck disable=SC2086
"$radctl" fetch -o again.hdr $ids || fail "fetch of all planes in colours"
first=${ids%%
*}
expect 65 "a plane that another has shown" "twice" "$radctl" fetch -o x.hsr \
    "$first" "$first"
expect 64 "is plane 1 of 2: name the jobs of all planes" "a lone plane" \
    "$radctl" fetch -o x.hdr "$first"
# a plane that was asked for alone is to be had alone
# shellcheck disable=SC2086
alone=$("$radsubmit" --detach $view -cs 6 --plane 1 -ab 1 -ad 64 "$room" \
    2>stderr) || fail "--plane --detach: $(cat stderr)"
# shellcheck disable=SC2086
"$radsubmit" $view -cs 6 --plane 1 -ab 1 -ad 64 -o alone.hdr "$room" \
    2>stderr || fail "--plane: $(cat stderr)"
until_true 60 "$radctl" fetch --plane -o again.hdr "$alone" ||
    fail "radctl fetch --plane"
cmp alone.hdr again.hdr || fail "radctl fetch --plane gets another picture"
# shellcheck disable=SC2086
expect 74 " --plane -o FILE" "no room for a plane" \
    "$radsubmit" $view -cs 6 --plane 1 -ab 1 -ad 64 -o /dev/full "$room"
# shellcheck disable=SC2086
expect 74 "the coordinator keeps the picture: radctl fetch " \
    "no room for all bands" \
    "$radsubmit" $view -cs 6 -ab 1 -ad 64 -o /dev/full "$plain"
grep -q 'plane' stderr && fail "one job has no planes: $(cat stderr)"
expect 64 "--plane gets three bands alone" "spectra of a plane" \
    "$radctl" fetch --plane -o x.hsr "$alone"
expect 64 "--plane is for one job" "planes alone" \
    "$radctl" fetch --plane -o x.hdr "$alone" "$first"
id=$("$radsubmit" -x 8 -y 8 -o plain.hdr "$room" 2>&1 |
    sed -n 's/radsubmit: job //p')
expect 65 "shows no plane" "three bands" "$radctl" fetch -o x.hsr "$first" "$id"
expect 64 "spectra have more than three bands" "spectra of one job" \
    "$radctl" fetch -o x.hsr "$id"

# one job of all bands is fetched as it would have come
# shellcheck disable=SC2086
"$radsubmit" $view -cs 6 -ab 1 -ad 64 -o far.hsr "$plain" 2>far.err ||
    fail "all bands from one job: $(cat far.err)"
cmp plain.hsr far.hsr || fail "far.hsr of one job is another picture"
id=$(sed -n 's/radsubmit: job \([0-9a-f]*\)$/\1/p' far.err)
"$radctl" fetch -o again.hsr "$id" || fail "fetch of all bands"
cmp far.hsr again.hsr || fail "radctl fetch makes another picture of one job"
"$radctl" fetch -o again.hdr "$id" || fail "fetch of all bands in colours"
expect 64 "shows all bands: name that one alone" "all bands, twice" \
    "$radctl" fetch -o x.hsr "$id" "$id"

# left to the coordinator, with the caches of the last picture's planes
# shellcheck disable=SC2086
ids=$("$radsubmit" $view -cs 6 -ab 1 -ad 64 --reuse=last --detach \
    "$room" 2>left.err) || fail "--detach: $(cat left.err)"
[ "$(echo "$ids" | wc -l)" -eq 2 ] || fail "--detach: $ids"
# shellcheck disable=SC2086
all_done() { [ "$("$radctl" jobs | grep -c 'done.*plane . of 2')" -ge 4 ]; }
until_true 60 all_done || fail "--detach is not done: $("$radctl" jobs)"
# shellcheck disable=SC2086
"$radctl" fetch -o left.hsr $ids || fail "fetch of what was left"
[ "$(grep -c 'begins with the ambient values' left.err)" -eq 2 ] ||
    fail "--reuse=last: $(cat left.err)"
[ -s left.hsr ] || fail "no picture of what was left"

# rays of a pixel change no plane's name
"$radsubmit" -cs 6 -x 24 -y 18 --samples=2 -o samples.hsr "$room" 2>samples.err ||
    fail "samples.hsr: $(cat samples.err)"
ids=$(sed -n 's/radsubmit: job \([0-9a-f]*\), plane.*/\1/p' samples.err)
# shellcheck disable=SC2086
"$radctl" fetch -o again.hsr $ids || fail "fetch of planes of --samples"
cmp samples.hsr again.hsr || fail "--samples: radctl fetch makes another picture"

# Frames are put together one by one, and all are shown as the first, which is
# darker than the second.
cat >walk.vf <<EOF
VIEW= -vtv -vp 2 .15 1.3 -vd 0 1 -.6 -vu 0 0 1 -vh 40 -vv 30
VIEW= -vd 0 1 .6
EOF
"$radsubmit" -cs 6 -x 24 -y 18 -S 1 --views=walk.vf -o walk%d.png "$room" \
    2>walk.err || fail "walk%d.png: $(cat walk.err)"
ids=$(sed -n 's/radsubmit: job \([0-9a-f]*\), plane.*/\1/p' walk.err)
# shellcheck disable=SC2086
"$radctl" fetch -o all%d.png $ids || fail "fetch of all planes' frames"
# shellcheck disable=SC2086
"$radctl" fetch --frame=2 -o one.png $ids || fail "fetch of planes' second frame"
for n in 1 2; do
    cmp walk$n.png all$n.png || fail "frame $n is another picture"
done
cmp walk2.png one.png || fail "the second frame is not shown as the first"
finish
