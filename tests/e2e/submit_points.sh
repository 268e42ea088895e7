#!/bin/sh
# submit_points.sh - sensor points: values in the order of the input, the same
# from any cluster, formats, and what is refused
# shellcheck disable=SC2086 # options are words
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

# inside of a sphere that shines all is known
cat >box.rad <<'EOF'
void glow shine 0 0 4 2 2 2 0
shine bubble box 0 0 4 0 0 0 10
EOF

awk 'BEGIN { for (i = 0; i < 500; i++)
    printf "%d %d %d 0 0 %d\n", i * 37 % 11 - 5, i * 17 % 7 - 3, i % 5 - 2,
        i % 2 ? 1 : -1 }' >points.txt

# radiance 2 all round; the way to the wall is sqrt(100 - x^2 - y^2) -+ z
"$radsubmit" --local --threads=1 --points=points.txt -h- -oovL box.rad \
    >out.txt 2>stderr || fail "values: $(cat stderr)"
paste points.txt out.txt | awk '
    { far = sqrt(100 - $1 * $1 - $2 * $2) - $3 * $6
      if ($7 != $1 || $8 != $2 || $9 != $3 || $10 != 2 || $12 != 2 ||
          ($13 - far) ^ 2 > 1e-8) bad = bad " " NR }
    END { if (NR != 500 || bad) { print NR ":" bad; exit 1 } }' ||
    fail "values of a bubble"

# surfaces have the names that rtrace gives them, faces of a mesh one of all
cp "$scenes/ball.rtm" .
cat >mesh.rad <<'EOF'
void plastic red 0 0 5 .5 .1 .1 0 0
void mesh ball 1 ball.rtm 0 0
red ring floor 0 0 8 0 0 -9 0 0 1 0 99
EOF
printf '0 0 20 0 0 -1\n50 0 20 0 0 -1\n50 0 20 0 0 1\n' >three.txt
"$radsubmit" --local --points=three.txt -h- -osm mesh.rad >names.txt \
    2>stderr || fail "names: $(cat stderr)"
printf 'M-Tri\tb\t\nfloor\tred\t\n*\t*\t\n' | cmp - names.txt ||
    fail "names: $(cat names.txt)"

# the same bytes whoever makes them, with indirect light too
room=$scenes/room.rad
awk 'BEGIN { for (i = 0; i < 400; i++)
    printf "%g %g .8 0 0 1\n", .2 + i * 7 % 20 / 6, .2 + int(i / 20) / 6 }' \
    >grid.txt
opts='-I -h- -fad -ab 1 -ad 64 -as 0 -aa .2'
"$radsubmit" --local --threads=1 --points=grid.txt $opts "$room" >one.bin \
    2>stderr || fail "one: $(cat stderr)"
[ "$(wc -c <one.bin)" -eq $((400 * 24)) ] || fail "doubles: $(wc -c <one.bin)"
for way in auto window static scanbar; do
    "$radsubmit" --local --workers=4 --threads=1 --partition=$way \
        --points=- $opts "$room" <grid.txt >many.bin 2>stderr ||
        fail "$way: $(cat stderr)"
    cmp one.bin many.bin || fail "four workers, $way"
done

# values of a file serve, and change nothing; colours have a size
for way in makes uses; do
    "$radsubmit" --local --threads=1 --points=grid.txt $opts -af grid.amb \
        "$room" >$way.bin 2>stderr || fail "-af: $(cat stderr)"
    cmp one.bin $way.bin || fail "a file of ambient values, $way"
done
[ -s grid.amb ] || fail "no ambient values"
"$radsubmit" --local --threads=1 --points=grid.txt -x 20 -y 20 -I -fac -ab 0 \
    "$room" >grid.hdr 2>stderr || fail "-fac: $(cat stderr)"
LC_ALL=C grep -aqx -- '-Y 20 +X 20' grid.hdr || fail "colours without a size"
[ "$(LC_ALL=C grep -ao -- ' -[xy] [0-9]*' grid.hdr | tr '\n' ' ')" = \
    ' -x 20  -y 20 ' ] || fail "sides in: $(head -n 3 grid.hdr)"

# what needs no light needs no job, and still has statistics
"$radsubmit" --local --points=points.txt -h- -oL --stats=none.json box.rad \
    >out 2>stderr || fail "-oL: $(cat stderr)"
grep -q '"objects": 2' none.json || fail "statistics of -oL: $(cat none.json)"

# what it would take, roughly: of so few points most make a record
"$radsubmit" --local --threads=1 --dry-run --points=grid.txt $opts \
    --stats=dry.json "$room" >dry.txt 2>stderr || fail "dry: $(cat stderr)"
grep -qx 'points   400' dry.txt || fail "--dry-run: $(cat dry.txt)"
"$radsubmit" --local --threads=1 --points=grid.txt $opts --stats=wet.json \
    "$room" >one.again 2>stderr || fail "wet: $(cat stderr)"
rays() { awk '/^ *"rays":/ { print $2 + 0; exit }' "$1"; }
awk -v a="$(rays dry.json)" -v b="$(rays wet.json)" \
    'BEGIN { exit !(a > b / 4 && a < 2 * b) }' ||
    fail "--dry-run says $(rays dry.json), and it took $(rays wet.json)"

# a room on a large ground, lit by what the sun sends in: a record that a few of
# its rays find lit, before dark walls, serves the places about it alone
cat >sunlit.rad <<'END'
void plastic wall 0 0 5 .5 .5 .5 0 0
wall polygon floor 0 0 12 0 0 0 6 0 0 6 4 0 0 4 0
wall polygon ceiling 0 0 12 0 0 3 0 4 3 6 4 3 6 0 3
wall polygon left 0 0 12 0 4 0 0 4 3 6 4 3 6 4 0
wall polygon back 0 0 12 0 0 0 0 0 3 0 4 3 0 4 0
wall polygon right 0 0 12 6 0 0 6 4 0 6 4 3 6 0 3
wall polygon front 0 0 30 0 0 0 6 0 0 6 0 3 0 0 3 0 0 0
    2 0 1 2 0 2.4 4 0 2.4 4 0 1 2 0 1
wall ring ground 0 0 8 3 2 -.01 0 0 1 0 100
void light solar 0 0 3 6e6 6e6 6e6
solar source sun 0 0 4 .3 -.8 .15 .533
END
awk 'BEGIN { for (i = 0; i < 96; i++)
    printf "%g %g .8 0 0 1\n", .25 + i % 12 / 2, .25 + int(i / 12) / 2 }' >seats.txt
sunlit() # NAME OPTIONS...
{
    name=$1
    shift
    "$radsubmit" --local --threads=1 --points=seats.txt -h- -I "$@" sunlit.rad \
        >"$name" 2>stderr || fail "sunlit room, $name: $(cat stderr)"
}
sunlit direct -ab 0
sunlit truth -ab 1 -aa 0 -ad 4096
for seed in 0 1 2; do
    sunlit cached -ab 1 -aa .1 -ad 512 -as 128 --seed=$seed
    paste direct truth cached | awk '{ a += $4 - $1; b += $7 - $1 }
        END { exit !(b > .9 * a && b < 1.1 * a) }' ||
        fail "indirect light of a sunlit room, seed $seed"
done

# refused STATUS TEXT OPTIONS...
refused()
{
    want=$1 text=$2
    shift 2
    "$radsubmit" --local "$@" box.rad >out 2>err </dev/null
    got=$?
    [ $got = "$want" ] || fail "status $got, not $want: $*: $(cat err)"
    grep -qF -- "$text" err || fail "$*: $(cat err)"
}
printf '0 0 0 0 0 1\n\n1 2 3 4 x 6\n' >word.txt
printf '0 0 0 0 0\n' >five.txt
refused 65 "word.txt:3: 'x' is not a number" --points=word.txt
refused 65 "five.txt:1: expected six numbers" --points=five.txt
refused 66 "no.txt" --points=no.txt
head -c 50 /dev/zero >part.bin
refused 65 "2 bytes behind sensor point 1" --points=part.bin -fda
refused 64 "--points and -vp exclude each other" --points=points.txt -vp 0 0 0
refused 64 "--points and --preview exclude each other" --points=points.txt --preview=a.png
refused 64 "--detach" --points=points.txt --detach
refused 64 "--job needs a coordinator" --points=points.txt --job="$(printf %032d 1)"
refused 64 "is no job's id" --points=points.txt --job=7
refused 64 "--job needs --points" --job="$(printf %032d 1)"
refused 64 "'t' of rtrace is not supported" --points=points.txt -otv
refused 64 "rtrace's -o has no 'D'" --points=points.txt -oD
refused 64 "'-I' is for --points" -I
refused 64 "'points.png'" --points=points.txt -o points.png
printf '1\0x 0 0 0 0 1\n' >nul.txt
refused 65 "is not a number" --points=nul.txt -ov
check_nothing_left "points"

# a normal that a texture turns, and as it is
cat >tilted.rad <<'END'
void texfunc tilt 4 .25 0 0 .
0
0
tilt plastic p 0 0 5 .5 .5 .5 0 0
p polygon floor 0 0 12 -9 -9 0  9 -9 0  9 9 0  -9 9 0
void light l 0 0 3 9 9 9
l sphere lamp 0 0 4 3 3 5 .2
END
echo "0 0 1 0 0 -1" >down.txt
"$radsubmit" --local --points=down.txt -h- -onN tilted.rad >turned 2>stderr ||
    fail "-onN: $(cat stderr)"
awk '{ l = sqrt(1.0625)
       if (($1 - .25 / l)^2 + $2^2 + ($3 - 1 / l)^2 > 1e-10 ||
           $4 != 0 || $5 != 0 || $6 != 1) exit 1 }' turned ||
    fail "a turned normal: $(cat turned)"

# textures before the material count, too, as gensurf -s writes them: with those
# of the material, and before an illum that names another
cat >smooth.rad <<'END'
void texfunc tilt 4 .25 0 0 . 0 0
tilt plastic p 0 0 5 .5 .5 .5 0 0
void plastic q 0 0 5 .5 .5 .5 0 0
void illum i 1 q 0 3 1 1 1
q texfunc before 4 .25 0 0 . 0 0
p texfunc both 4 0 .5 0 . 0 0
i texfunc lit 4 .25 0 0 . 0 0
q mixfunc mixed 4 tilt tilt 1 . 0 0
mixed ring r3 0 0 8 15 0 0 0 0 1 0 1
before ring r0 0 0 8 0 0 0 0 0 1 0 1
lit ring r1 0 0 8 5 0 0 0 0 1 0 1
both ring r2 0 0 8 10 0 0 0 0 1 0 1
END
printf '%s 0 1 0 0 -1\n' 0 5 10 15 >down3.txt
"$radsubmit" --local --points=down3.txt -h- -on smooth.rad >turned 2>stderr ||
    fail "-on: $(cat stderr)"
awk '{ y = NR == 3 ? .5 : 0; l = sqrt(1.0625 + y * y)
       if (($1 - .25 / l)^2 + ($2 - y / l)^2 + ($3 - 1 / l)^2 > 1e-10) exit 1 }
     END { exit NR != 4 }' turned ||
    fail "normals that textures before materials turn: $(cat turned)"

# met from behind: materials that rtrace shades from either side turn it, an
# alias has no texture but its own, an illum is what it names
cat >sides.rad <<'END'
void texfunc tilt 4 .25 0 0 .
0
0
tilt plastic p 0 0 5 .5 .5 .5 0 0
void alias plain p
tilt dielectric d 0 0 5 1 1 1 1.5 0
void illum i 1 p 0 3 1 1 1
p ring r0 0 0 8 0 0 0 0 0 1 0 1
plain ring r1 0 0 8 5 0 0 0 0 1 0 1
d ring r2 0 0 8 10 0 0 0 0 1 0 1
i ring r3 0 0 8 15 0 0 0 0 1 0 1
END
printf '%s 0 -1 0 0 1\n' 0 5 10 15 >up.txt
"$radsubmit" --local --points=up.txt -h- -on sides.rad >turned 2>stderr ||
    fail "-on: $(cat stderr)"
printf '%.6e\t%.6e\n' -.2425356 -.9701425 0 -1 .2425356 .9701425 \
    -.2425356 -.9701425 >want
sed 's/-0\.000000e+00/0.000000e+00/g' turned | cut -f1,3 | cmp - want ||
    fail "normals of both sides: $(cat turned)"

# interrupted, or not to be written: only who has the points can use the values
RADD_COORDINATOR=$work/coord.sock
export RADD_COORDINATOR
"$radcoord" --listen= --socket="$RADD_COORDINATOR" --state="$work/state" \
    2>>coord.log &
until_true 20 "$radctl" status || fail "no coordinator"
left() # TEXT OPTIONS...
{
    text=$1
    shift
    : >left.err
    "$radsubmit" --points=grid.txt "$@" "$room" >left.out 2>left.err &
    waits=$!
    until_true 30 grep -q "no worker has begun" left.err ||
        fail "nothing of no worker: $(cat left.err)"
    id=$(sed -n 's/^radsubmit: job //p' left.err)
    kill -TERM $waits
    wait $waits
    [ $? -eq 75 ] || fail "terminated: $(cat left.err)"
    grep -qF "the job goes on: $(printf "$text" "$id")" left.err ||
        fail "what to do: $(cat left.err)"
}
left 'submit again with --job=%s' -I
"$radctl" cancel "$id" || fail "cancel $id"
left 'submit again with --job=%s' $opts
left_id=$id
id=$("$radsubmit" --points=grid.txt $opts --detach "$room") ||
    fail "--detach"
"$radd" --coordinator="$RADD_COORDINATOR" --name=w --threads=1 \
    --listen=127.0.0.1:0 --cache="$work/cache" 2>>w.log &
is_done() { "$radctl" jobs | grep "$id" | grep -q done; }
until_true 60 is_done || fail "$id is not done: $("$radctl" jobs)"
for job in "$left_id" "$id"; do
    "$radsubmit" --points=grid.txt $opts --job="$job" "$room" >left.bin \
        2>stderr || fail "--job: $(cat stderr)"
    cmp one.bin left.bin || fail "values of a job that was left"
done
expect 65 "other files or options" "points of another job" "$radsubmit" \
    --points=points.txt $opts --job="$id" "$room"
expect 64 "radsubmit --job writes" "fetch" "$radctl" fetch "$id" -o x.hdr
"$radsubmit" --points=grid.txt $opts --reuse="$id" "$room" >again.bin \
    2>stderr || fail "--reuse: $(cat stderr)"
cmp one.bin again.bin || fail "values over the same cache"
expect 74 "--job=" "no room for the values" "$radsubmit" --points=grid.txt \
    $opts -o /dev/full "$room"
kept=$(sed -n 's/^radsubmit: the values are in //p' stderr)
[ -s "$kept" ] || fail "values that cannot be written are lost: $(cat stderr)"
cmp one.bin "$kept" || fail "values that are kept elsewhere"
rm -f "$kept"
# light that ends between sensors: those beyond the end do not get a neighbour's
cat >beam.rad <<'END'
void brightfunc beam 2 if(2.5-(Px-Dx*Pz/Dz),1,.01) . 0 0
beam glow g 0 0 4 10 10 10 0
g polygon sky 0 0 12 0 0 3 0 4 3 4 4 3 4 0 3
void plastic p 0 0 5 .5 .5 .5 0 0
p polygon far 0 0 9 60 0 0 60 1 0 60 0 1
END
awk 'BEGIN { for (x = .5; x < 5; x += .8) print x, 2, .1, 0, 0, 1 }' >end.txt
for aa in 0 .2; do
    "$radsubmit" --local --points=end.txt -h- -I -ab 1 -ar 16 -ad 1024 -as 0 \
        -aa $aa beam.rad >end.$aa 2>stderr || fail "-aa $aa: $(cat stderr)"
done
paste end.0 end..2 | awk '{ if ($1 < .9 * $4 || $1 > 1.1 * $4) exit 1 }' ||
    fail "light beyond its end: $(paste end.0 end..2)"
# a slab, and a pane in the open: no sensor gets the light of one that is inside
# of the slab or on the other side
cat >slab.rad <<'END'
void glow g 0 0 4 1 1 1 0
g source sky 0 0 4 0 0 1 180
void plastic p 0 0 5 .5 .5 .5 0 0
void glass pane 0 0 3 .5 .5 .5
p ring ground 0 0 8 0 0 0 0 0 1 0 50
p ring top 0 0 8 2 2 1.1 0 0 1 0 2
p ring bottom 0 0 8 2 2 1 0 0 -1 0 2
p cylinder edge 0 0 7 2 2 1 2 2 1.1 2
pane ring cover 0 0 8 2 2 2 0 0 1 0 2
END
awk 'BEGIN { n = split("1.05 1.1 1.15 1.99 2.01", z)
    for (x = 1; x < 2.6; x += .3)
        for (i = 1; i <= n; i++) print x, 2, z[i], 0, 0, 1 }' >slab.txt
for aa in 0 .2; do
    "$radsubmit" --local --threads=1 --points=slab.txt -h- -I -pA -ab 2 -ar 32 \
        -ad 512 -as 0 -aa $aa slab.rad >slab.$aa 2>stderr ||
        fail "a slab, -aa $aa: $(cat stderr)"
done
paste slab.0 slab..2 | awk '
    { if ($2 < .85 * $1 || $2 > 1.15 * $1) exit 1 } END { exit NR != 30 }' ||
    fail "light through a slab or a pane: $(paste slab.0 slab..2)"
finish
