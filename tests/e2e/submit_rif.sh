#!/bin/sh
# submit_rif.sh - a file of rad's variables as the scene: its views are one job,
# with rad's options, names, size and exposure; what is not done is said
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

cp "$scenes/room.rad" .
sed -n '/^void/p' room.rad >room.mat
sed '/^void/d' room.rad >walls.rad
cat >room.rif <<'EOF'
# a room, from two sides
mat= room.mat
scene= walls.rad '!echo red sphere knob 0 0 4 .5 2 1 .1' \
    # and no more
objects= none
ZONE= Interior 0 4 0 3 0 2.5
QUAL= Med
EXP= +2
RES= 60 40
render= -ab 0
rpict= -ps 1 -pj 0
view= south -vp 2 .15 1.3 -vd 0 1 -.12 -vh 75 -vv 60
view= Zl
EOF

# header FILE: what stands in the picture's header, and its size
header()
{
    LC_ALL=C sed -n '1,/^$/p' "$1"
    LC_ALL=C sed -n '/^$/{n;p;q;}' "$1"
}

run()
{
    "$radsubmit" --local --threads=1 "$@" 2>err || fail "$*: $(cat err)"
}

# in FILE WORDS: the header has them
in_header()
{
    header "$1" | grep -qF -- "$2" || fail "$1: no '$2' in $(header "$1")"
}

# two views, one job; names, options, size and exposure are rad's
run --stats=job.json room.rif
[ "$(grep -c 'radsubmit: job' err)" = 1 ] || fail "not one job: $(cat err)"
in_header room_south.hdr " -vp 2 0.15 1.3 -vd 0 1 -0.12 "
in_header room_south.hdr "EXPOSURE=4.000000e+00"
in_header room_south.hdr "-Y 40 +X 53"
in_header room_south.hdr " -ps 1 -pt 0.08 "
in_header room_south.hdr " -dc 0.7 "
in_header room_south.hdr " -ab 0 "
in_header room_Zl.hdr "-vtl -vp 2 1.5 2.38 -vd 0 0 -2.5 -vu 0 1 0 -vh 5.59"
in_header room_Zl.hdr "-Y 40 +X 40"
grep -q '"frames": 2' job.json || fail "not two frames"

# the large picture is twice as large, and these are filtered: another exposure
# changes no more than the header and the exponents
run --view=south room.rif "render=-av .045 .045 .045" PIC=bright "EXP= +3"
in_header bright_south.hdr "EXPOSURE=8.000000e+00"
[ ! -e bright_Zl.hdr ] || fail "--view does not choose"
"$top_builddir/raderr" bright_south.hdr room_south.hdr >change
grep -q '^max 0$' change || fail "an exposure is more than a factor: $(cat change)"
run --view=south room.rif "render=-av .045 .045 .045" PIC=third "EXP= 3"
in_header third_south.hdr "EXPOSURE=3.000000e+00"
"$top_builddir/raderr" third_south.hdr room_south.hdr |
    awk '$1 == "max" && $2 < .02 { ok = 1 } END { exit !ok }' ||
    fail "an exposure of 3 loses more than steps of the format"
run --oversample=1 --view=1 -o raw.hdr room.rif QUAL=Med
"$top_builddir/raderr" raw.hdr room_south.hdr | grep -q '^max 0$' &&
    fail "QUALITY=Med does not filter"

# without filter and exposure, as rad leaves a picture that is RAWFILE, too
run --view=south room.rif RAW=room2 PIC=room2
in_header room2_south.hdr "-Y 80 +X 106"
header room2_south.hdr | grep -q EXPOSURE && fail "a raw picture is exposed"

# the command line overrules, also what a view says; a name's %s is the view's
run -o "big %s.hdr" -x 30 -vv 30 -dt 0 room.rif
in_header "big south.hdr" " -vv 30 "
in_header "big south.hdr" " -dt 0 "
in_header "big Zl.hdr" " -vv 30 "
run --quality=draft -ab 0 --view=Xl -o draft.hdr room.rif
in_header draft.hdr " -dp 64 "
run --view="-vp 2 1 1 -vtc" -o other.hdr room.rif
in_header other.hdr "-vtc -vp 2 1 1 "

# the same pictures from the .rad files and options that rad would use
run -vp 2 .15 1.3 -vd 0 1 -.12 -vh 75 -vv 60 -x 60 -y 40 --oversample=2 \
    -dp 512 -ar 40 -ms .079 -ds .3 -dt .07 -dc .7 -dr 1 -ss 1 -st .1 \
    -aa .2 -ad 329 -as 42 -av .045 .045 .045 -lr 8 -lw 1e-4 -ab 0 \
    -ps 1 -pt .08 -pj 0 -o same.hdr \
    room.mat walls.rad '!echo red sphere knob 0 0 4 .5 2 1 .1'
[ "$(header same.hdr | grep '^radsubmit')" = \
    "$(header room_south.hdr | grep '^radsubmit')" ] ||
    fail "other options: $(header same.hdr)"

# OPTFILE, REPORT, ZFILE; a .png is shown with the exposure
run --view=south -o a.png room.rif OPT=opt REP="1 said" ZF=dist QUA=Low
grep -qx -- '-dt .1' opt || fail "OPTFILE: $(cat opt)"
grep -qx -- '-ab 0' opt || fail "OPTFILE lacks render=: $(cat opt)"
grep -q 'radsubmit: done' said || fail "REPORT's file: $(cat said)"
[ "$(wc -c <dist_south.zbf)" = $((53 * 40 * 4)) ] || fail "ZFILE"
run --view=south --exposure=4 -o b.png room.rif QUA=Low
cmp -s a.png b.png || fail "EXPOSURE of a .png is not --exposure"
run --view=south --format=png room.rif QUA=Low PIC=screen
cmp -s a.png screen_south.png || fail "--format=png gives no .png's name"

# what is not done is said, a line each
run --dry-run room.rif RAW=x "pf=-m .1 -r 1 -e 2" "oconv=myoconv -f" "EXP=1" >dry
for word in 'RAWFILE: ' "pfilt: '-m' is not done" "pfilt: '-r' is not done" \
    "oconv: 'myoconv' is not run"; do
    grep -qF "radsubmit: warning: room.rif: $word" err ||
        fail "not said: $word: $(cat err)"
done
grep -q '^picture' dry || fail "no dry run"
grep -v '^EXP' room.rif >dark.rif
run --view=south dark.rif
grep -q 'EXPOSURE: not given' err || fail "not said: $(cat err)"
run --dry-run dark.rif "pf=-e 2" >dry
grep -q "'-e' is not done: there is no EXPOSURE" err || fail "-e: $(cat err)"
header dark_south.hdr | grep -q EXPOSURE && fail "an exposure from nowhere"

# an octree as it is; surfaces of illum=, until mkillum's octree is there
"$top_builddir/radscene" freeze room.rad >room.oct
printf 'view= X\nEXP=1\nRES=16\n' >oct.rif
run oct.rif OCT=room.oct
[ -s oct_X.hdr ] || fail "an octree is no scene"
printf 'red sphere extra 0 0 4 3 1 1 .2\n' >extra.rad
run --view=south room.rif ill=extra.rad PIC=ill OCT=model.oct
grep -q 'room.rif: illum: mkillum is not run' err || fail "illum: $(cat err)"
cp room.oct model1.oct
run --view=south room.rif ill=extra.rad PIC=ill1 OCT=model.oct
grep -q mkillum err && fail "mkillum's octree is not taken"

# an ambient file that is older than the scene goes
run --view=south -ab 1 room.rif AMB=room.amb QUAL=Low
[ -s room.amb ] || fail "no AMBFILE"
touch -d '2 days ago' room.amb
run --view=south -ab 1 room.rif AMB=room.amb QUAL=Low
grep -q 'AMBFILE: its values were older' err || fail "AMBFILE: $(cat err)"

# refused STATUS WORDS ARGUMENT...: with one line that has the words
refused()
{
    status=$1 words=$2
    shift 2
    "$radsubmit" --local --threads=1 "$@" >out 2>err
    [ $? = "$status" ] || fail "$*: not status $status: $(cat err)"
    grep -qF -- "$words" err || fail "$*: '$words' is not in: $(cat err)"
}
printf 'scene= room.rad\nQUAL= fine\n' >bad.rif
refused 65 "bad.rif:2: QUALITY: 'fine': expected low" bad.rif
printf 'scene= room.rad\n\nfoo= fine\n' >bad.rif
refused 65 "bad.rif:3: unknown variable 'foo'" bad.rif
refused 65 "room.rif: mkpmap: photon maps are not supported" room.rif mkp=-x
refused 65 "room.rif: PGMAP: photon maps are not supported" room.rif "PG=a 1"
refused 65 "oconv: -i: files cannot be added" room.rif "oco=-i a.oct"
refused 65 "RESOLUTION: expected columns" room.rif RES=none
refused 65 "room.rif: EXPOSURE: expected stops" room.rif EXP=0
refused 65 "room.rif: pfilt: -e: expected stops" room.rif "pf=-e none"
refused 65 "room.rif: REPORT: expected minutes" room.rif "REP=often said"
{
    cat room.rif
    echo 'view= east -vp 1 1 1 -vq 3'
} >bad.rif
refused 64 "bad.rif:14: unknown option '-vq'" bad.rif
{
    cat room.rif
    echo 'view= my room -vp 1 1 1'
} >bad.rif
refused 65 "bad.rif:14: view 'my': 'room -vp 1 1 1' is no option" bad.rif
{
    cat room.rif
    echo 'render= -dt none'
} >bad.rif
refused 64 "bad.rif:14: option '-dt'" bad.rif
refused 64 "'PIC' after 'room.rif': expected VARIABLE=value" room.rif PIC
refused 64 "unknown variable 'foo'" room.rif foo=1
refused 64 "no %s for the view's name" -o one.hdr room.rif
refused 64 "option '--view': 'nowhere': none of the file's views (south, Zl)" \
    --view=nowhere room.rif
refused 64 "option '--view': '3': 2 views are there" --view=3 room.rif
refused 64 "--view is for a .rif file" --view=X room.rad
refused 64 "option '-S': the views are those of" -S 1 -o a%d.hdr room.rif
refused 64 "is the file of variables" --view=X -o room.rif room.rif
printf "view= X\n" >none.rif
refused 66 "no scene=, and no octree 'none.oct'" none.rif
refused 66 "missing.rif" missing.rif
finish
