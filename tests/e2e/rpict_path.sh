#!/bin/sh
# rpict_path.sh - command lines of programs that call rpict, with the rpict
# of --rpict-path: as rad, ranimate and rpiece write them
# shellcheck disable=SC2086,SC2016 # options are words, and a $ is rpict's
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

folder=$("$radsubmit" --rpict-path) || fail "--rpict-path"
[ -x "$folder/rpict" ] || fail "no rpict in '$folder'"
PATH=$folder:$PATH
RADD_RPICT_OPTIONS='--local --threads=1'
export PATH RADD_RPICT_OPTIONS
[ "$(command -v rpict)" = "$folder/rpict" ] || fail "PATH finds another"

cp "$scenes/room.rad" .
"$top_builddir/radscene" freeze room.rad >room.oct
opts='-ds .3 -dt .07 -dc .7 -dr 1 -ss 1 -st .1 -ab 0'
opts="$opts -av .01 .01 .01 -lr 8 -lw 1e-4"
vw='-vp 2 .15 1.3 -vd 0 1 -.12 -vh 75 -vv 60'
printf -- '-ab 0\n-aw 0\n' >rif.opt
printf 'VIEW= -vtv %s\n' "$vw" >vf

# is FILE COLUMNS ROWS: a picture of that size, alone in its file
is()
{
    LC_ALL=C sed -n '/^$/{n;p;q;}' "$1" | grep -qx -- "-Y $3 +X $2" ||
        fail "$1 is no picture of $2 by $3: $(head -c 600 "$1" | head -n 9)"
}
status() # STATUS COMMAND LINE
{
    want=$1
    shift
    sh -c "$*" >out 2>err </dev/null
    got=$?
    [ $got = "$want" ] || fail "status $got, not $want: $*: $(cat err)"
}

# --- rad: a picture, an overture, options from a file, distances
status 0 rpict -t 60 -e said $vw -x 32 -y 32 $opts -ps 8 -pt .08 -z a.zbf \
    room.oct ">a.unf"
is a.unf 32 24
[ "$(wc -c <a.zbf)" = $((32 * 24 * 4)) ] || fail "-z"
echo first >said
status 0 rpict -t 600 -e said -vf vf -x 32 -y 32 @rif.opt -ps 1 room.oct ">b.unf"
is b.unf 32 24
status 0 rpict -pa -1 -vf vf -x 16 -y 16 @rif.opt -ps 1 room.oct ">b.unf"
is b.unf 16 16
[ "$(sed -n 1p said)" = first ] || fail "-e: $(cat said)"
grep -q 'done in' said || fail "-e: $(cat said)"
status 0 rpict $vw -x 64 -y 64 -ps 1 -af a.amb -ab 1 -ad 32 -aa .4 room.oct \
    ">/dev/null"
[ ! -s err ] || fail "rpict says nothing of what goes well: $(cat err)"
[ -s a.amb ] || fail "the overture leaves no ambient values"
status 0 rpict -w $vw -x 16 -y 16 -pa 1.000 room.oct ">c.unf"
status 0 rpict -w0 $vw -x 16 -y 16 "<room.oct >d.unf"
[ "$(tail -c 400 c.unf | cksum)" = "$(tail -c 400 d.unf | cksum)" ] ||
    fail "an octree on standard input"
status 0 rpict $vw -w0 -x 16 -y 16 "'!cat room.oct' >d.unf"
[ "$(tail -c 400 c.unf | cksum)" = "$(tail -c 400 d.unf | cksum)" ] ||
    fail "an octree that a command writes"
status 0 "ROPT='-x 16 -y 16'" rpict '\$ROPT' -vf vf -o e.unf room.oct
is e.unf 16 12
[ ! -s out ] || fail "-o, and something on standard output"

# an octree that is not frozen is a list of files and commands, of our folder
# wherever it is itself
mkdir octrees
{
    printf '#?RADIANCE\nFORMAT=Radiance_octree\n\n\001\0370\0000\0000\0001\000'
    printf '!grep ^void room.rad\000bare.rad\000\000'
    printf '\000\000\000\020\000' # 16 objects
} >octrees/list.oct
grep -v ^void room.rad >bare.rad
status 0 rpict $vw -x 16 -y 16 -ps 1 -pj 0 octrees/list.oct ">f.unf"
status 0 rpict $vw -x 16 -y 16 -ps 1 -pj 0 room.oct ">g.unf"
[ "$(tail -c 400 f.unf | cksum)" = "$(tail -c 400 g.unf | cksum)" ] ||
    fail "an octree elsewhere, of files and commands here"

# --- rad's recovery: view and size are the file's, which is made anew
head -c 700 a.unf >part.unf
status 0 rpict $opts -ps 8 -pt .08 -ro part.unf room.oct
is part.unf 32 24
grep -aq '^VIEW= -vtv -vp 2 0.15 1.3' part.unf || fail "view of -ro"
head -c 700 a.unf >part.unf
status 0 rpict $opts -r part.unf room.oct ">whole.unf"
is whole.unf 32 24
status 0 rpict -x 16 -y 16 -ro new.unf -vf vf room.oct
is new.unf 16 12
grep -q 'new output file' err || fail "a ghost file: $(cat err)"
: >empty.unf
status 2 rpict -ro empty.unf room.oct
[ ! -e empty.unf ] || fail "an empty file stays in the way"
echo text >text.unf
status 2 rpict -ro text.unf room.oct
status 1 rpict $opts -ps 8 -pt .08 "</dev/null" # as where oconv failed

# --- ranimate: a walk; frames that are there stay; one is made again
awk 'BEGIN { for (k = 0; k < 4; k++)
    printf "rvu -vtv -vp 2 %g 1.3 -vd 0 1 -.12 -vh 75 -vv 60\n", .15 + .1 * k
}' >walk.vf
: >walk003.unf
status 0 rpict @rif.opt -w0 -z walk%03d.zbf -o walk%03d.unf -x 16 -y 16 \
    -pa 1 -S 2 -PP host.persist room.oct "<walk.vf"
for k in 2 4 5; do
    is walk00$k.unf 16 12
    grep -aqx "FRAME=$k" walk00$k.unf || fail "frame $k is another"
done
[ ! -s walk003.unf ] || fail "frame 3 was there"
[ ! -e walk003.zbf ] || fail "distances of a frame that was there"
[ ! -e host.persist ] || fail "a persist file"
cp walk004.unf saved
head -c 300 saved >walk004.unf
status 0 rpict @rif.opt -w0 -o walk%03d.unf -x 16 -y 16 -S 2 -r 4 \
    room.oct "<walk.vf"
cmp -s walk004.unf saved || fail "-S -r: frame 4 is not made again"
[ ! -s walk003.unf ] || fail "-S -r: frame 3 was there"
status 0 rpict @rif.opt -o walk%03d.unf -x 16 -y 16 -S 2 room.oct "<walk.vf"
grep -q 'nothing is rendered' err || fail "all frames are there: $(cat err)"

# names that look like options, and numbers like octal ones
cp -- saved ./-a.hdr
status 0 rpict @rif.opt -r -a.hdr room.oct
[ -s ./-a.hdr ] || fail "-r -a.hdr: nothing is there"
status 0 rpict @rif.opt -w0 -o -q%d.hdr -x 16 -y 16 -S 010 room.oct "<walk.vf"
[ -s ./-q10.hdr ] || fail "-S 010 does not begin with frame 10"
: >./-q10.hdr
status 0 rpict @rif.opt -w0 -o -q%d.hdr -x 16 -y 16 -S 10 -r 10 room.oct \
    "<walk.vf"
[ -s ./-q10.hdr ] || fail "-r 10: a frame of that name is not made again"
status 0 rpict @rif.opt -x 16 -y 16 -S 08 room.oct "<walk.vf"

# --- rad -N: one view on standard input, the picture on standard output
status 0 rpict -S 1 -PP pfabc -x 16 -y 16 @rif.opt -ps 1 room.oct \
    "<vf >persist.unf"
is persist.unf 16 12
[ ! -e pfabc ] || fail "a persist file"

# --- rpiece: a picture comes before the next view is said; views add up
mkfifo views pictures
rpict -S 1 -vf vf -x 12 -y 12 -pa 0 -pm 0 room.oct <views >pictures 2>err &
exec 3>views 4<pictures
printf 'VIEW= -vs .25\n' >&3
header=$(while IFS= read -r line; do
    echo "$line"
    case $line in -Y*) break ;; esac
done <&4)
echo "$header" | grep -q -- '-Y 12 +X 12' || fail "rpiece: no first picture"
echo "$header" | grep -q -- '-vh 75 .* -vs 0.25 ' || fail "rpiece: $header"
printf '# no view\nVIEW= -vl .5\n' >&3
exec 3>&-
cat <&4 >rest
exec 4<&-
wait $! || fail "rpiece: $(cat err)"
grep -aq -- '-vs 0.25 -vl 0.5' rest || fail "rpiece: views do not add up"
grep -aqx FRAME=2 rest || fail "rpiece: no second picture"

status 0 rpict -S 1 room.oct
grep -q 'no output produced' err || fail "no view, and nothing said: $(cat err)"

# --- what is refused, with rpict's statuses
status 1 rpict -zz room.oct
status 1 rpict $vw room.oct other.oct
status 1 rpict -S 1 "<vf"
status 1 rpict -o
refused() # TEXT COMMAND LINE
{
    text=$1
    shift
    status 1 "$@"
    grep -qF -- "$text" err || fail "$*: $(cat err)"
}
refused "'a=1' is an expression" rpict -e "'a=1'" $vw room.oct
refused "'a:1' is an expression" rpict -e a:1 $vw room.oct
[ ! -e 'a=1' ] && [ ! -e a:1 ] || fail "a definition is taken for -e's file"
refused "'-f' of rpict" rpict -f a.cal $vw room.oct
refused "'-ap' of rpict" rpict -ap a.pm 50 $vw room.oct
refused "'-features'" rpict -features
for word in -I -h -hn -ld -ov -ff; do # rtrace's
    refused "at '$word'" rpict $vw $word room.oct
done
status 1 rpict -vu 0 1 0 room.oct
status 2 rpict $vw nothing.oct
status 2 rpict $vw -x 8 -y 8 -o e.unf room.oct
is e.unf 16 12
status 2 rpict $vw -x 8 -y 8 -o nowhere/e.unf room.oct
status 0 rpict -ab 3 -defaults
grep -qx -- '-ab 3 .*' out || fail "-defaults: $(cat out)"
status 0 rpict -version

# the options' values are counted right: each of -defaults stands alone, too,
# before a scene on standard input
"$radsubmit" -defaults | sed 's/ *#.*//' | grep -v '^--' >all
while read -r line; do
    status 0 rpict $line -x 4 -y 4 -vf vf "<room.oct"
done <all
# a switch takes no word behind it, however it says on or off
for switch in -i -u -w -bv -dv -co; do
    for onoff in + 1 y Y t T - 0 n N f F; do
        status 0 rpict $switch$onoff -defaults
    done
done
status 0 rpict -x 4 -y 4 -vf vf -iy room.oct ">h.unf"
is h.unf 4 3
finish
