#!/bin/sh
# submit_outputs.sh - what is written keeps its place and its mode, and takes
# away nothing that is read
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

cp "$scenes/room.rad" room.rad
cp "$scenes/room.vf" v.vf
render="$radsubmit --local --workers=1 --threads=1 -x 16 -y 12"

# shellcheck disable=SC2086 # options are words
draw()
{
    $render -vf "$scenes/room.vf" "$@" room.rad 2>stderr || {
        fail "$*: $(cat stderr)"
        return 1
    }
}

mode_of()
{
    stat -c %a "$1"
}

draw -o plain.hdr
[ "$(mode_of plain.hdr)" = "$(: >new && mode_of new)" ] ||
    fail "a new file has mode $(mode_of plain.hdr)"

# --- modes and links ---

: >private.hdr
chmod 600 private.hdr
: >group.json
chmod 640 group.json
draw -o private.hdr --stats=group.json --preview=prev.png
cmp private.hdr plain.hdr || fail "the private picture is another"
[ "$(mode_of private.hdr)" = 600 ] || fail "0600 became $(mode_of private.hdr)"
[ "$(mode_of group.json)" = 640 ] || fail "0640 became $(mode_of group.json)"

# one that cannot be written keeps no picture of an animation from its place
printf 'rview -vp 1 1 1 -vd 1 0 0\nrview -vp 1 1 1 -vd 0 1 0\n' >two.vf
# shellcheck disable=SC2086 # options are words
expect 74 "cannot write '/dev/full'" "a preview on a full disk" \
    $render -S 1 --views=two.vf --preview=/dev/full -o f%d.hdr room.rad
[ "$(grep -c 'warning: no preview, but the job goes on: cannot write' stderr)" \
    -eq 1 ] || fail "a preview on a full disk is not told once: $(cat stderr)"
[ -s f1.hdr ] && [ -s f2.hdr ] ||
    fail "a preview on a full disk lost a picture"

# nor is what is said and printed lost in silence
# shellcheck disable=SC2086
expect 74 "cannot write '/dev/full'" "messages on a full disk" \
    $render -vf v.vf -e /dev/full -o said.hdr room.rad
cmp said.hdr plain.hdr || fail "messages on a full disk lost the picture"
# -e adds to a file, as rpict does: rad and scripts give it to many runs
for i in 1 2; do
    draw -e said -o said.hdr --progress=always
done
[ "$(grep -c '^radsubmit: job ' said)" -eq 2 ] || fail "-e: $(cat said)"
for option in -defaults --help --version --rpict-path; do
    expect 74 "cannot write: No space" "$option on a full disk" \
        sh -c "'$radsubmit' $option >/dev/full"
done
# shellcheck disable=SC2086
expect 74 "cannot write: No space" "a forecast on a full disk" \
    sh -c "$render -vf v.vf --dry-run room.rad >/dev/full"
expect 74 "cannot write: No space" "radctl --help on a full disk" \
    sh -c "'$radctl' --help >/dev/full"

# shellcheck disable=SC2086
expect 74 "File too large" "files that may not grow" \
    sh -c "ulimit -f 1; exec $render -vf v.vf -x 100 -y 100 -o big.hdr room.rad"
! [ -e big.hdr ] || fail "half a picture"

# each frame has its folder, or nothing is rendered
mkdir f1
# shellcheck disable=SC2086
expect 73 "cannot create 'f2/x.hdr': no such folder" "a frame's folder" \
    $render -S 1 --views=two.vf -o f%d/x.hdr room.rad
! [ -e f1/x.hdr ] || fail "the first frame was rendered in vain"

mkdir elsewhere
ln -s elsewhere/made.hdr dangling.hdr
ln -s dangling.hdr twice.hdr
draw -o twice.hdr
[ -L dangling.hdr ] && [ -L twice.hdr ] || fail "a link was replaced"
cmp elsewhere/made.hdr plain.hdr || fail "nothing where the link leads"
chmod 600 elsewhere/made.hdr
draw -o twice.hdr
[ "$(mode_of elsewhere/made.hdr)" = 600 ] || fail "the mode behind a link"
ln -s nowhere/x.hdr lost.hdr
expect 73 "no such folder" "a link into nothing" $render -o lost.hdr room.rad
ln -s loop.hdr loop.hdr
expect 73 "cannot create 'loop.hdr'" "a link to itself" \
    $render -o loop.hdr room.rad

# --- what is no file ---

mkfifo pipe
cat pipe >piped.hdr &
draw -o pipe
wait $!
cmp piped.hdr plain.hdr || fail "what came through the pipe is another"
[ -p pipe ] || fail "the pipe was replaced"
echo "what was there" >log.hdr
# shellcheck disable=SC2086
$render -vf "$scenes/room.vf" -o /dev/stdout room.rad >>log.hdr 2>stderr ||
    fail "/dev/stdout: $(cat stderr)"
{ echo "what was there" && cat plain.hdr; } | cmp - log.hdr ||
    fail "/dev/stdout did not go on where it was"

# a picture that is written needs no second one
mkdir rescued
status=0
# shellcheck disable=SC2086
TMPDIR=$work/rescued $render -vf "$scenes/room.vf" -o a.hdr -z /dev/full \
    room.rad 2>stderr || status=$?
[ $status -eq 74 ] || fail "a full disk: status $status"
cmp a.hdr plain.hdr || fail "the picture is not there"
find rescued -name '*.hdr' | grep . && fail "a stray copy of the picture"
grep -q "distances are in" stderr || fail "the distances are lost: $(cat stderr)"

# --- inputs ---

# refused WHAT OPTION...: and nothing is changed
refused()
{
    what=$1
    shift
    # shellcheck disable=SC2086
    expect 64 "$what" "$*" $render "$@"
}
cp v.vf before.vf
refused "'v.vf' is the view file: -o would" -vf v.vf -o v.vf room.rad
refused "'./v.vf' is the view file" -vf v.vf -z ./v.vf -o x.hdr room.rad
ln -s v.vf soft.vf
ln v.vf hard.vf
refused "'soft.vf' is the view file" -vf v.vf -o soft.vf room.rad
refused "'hard.vf' is the view file" -vf v.vf -o hard.vf room.rad
refused "is the view file: -e would" -vf v.vf -e hard.vf -o x.hdr room.rad
# a file of the scene, which is known as one when -e is open, or the key
printf 'void brightfunc b 2 one one.cal 0 0\nb plastic w 0 0 5 1 1 1 0 0
w sphere s 0 0 4 1 1 1 .1\n' | cat - room.rad >with.rad
echo 'one : 1;' >one.cal
printf 'user:a:k1 %064d\n' 1 >user.key
chmod 600 user.key
cp one.cal before.cal
cp user.key before.key
refused "'one.cal' is a file of the scene: -e would" -vf v.vf -e one.cal -o x.hdr \
    with.rad
# not even by the message that the scene cannot be read
printf 'one : 1 +;' >one.cal
cp one.cal bad.cal
expect 65 "one.cal" "-e of a broken .cal" $render -vf v.vf -e one.cal -o x.hdr \
    with.rad
cmp one.cal bad.cal || fail "-e changed a broken .cal"
cp before.cal one.cal
expect 64 "'user.key' is the key: -e would" "-e KEY" env RADD_KEY=user.key \
    "$radsubmit" --coordinator=127.0.0.1:1 -e user.key -o x.hdr room.rad
cmp one.cal before.cal && cmp user.key before.key || fail "-e changed a file"
cp v.vf walk1.hdr
refused "'walk1.hdr' is the file of views" -S 1 --views=walk1.hdr \
    -o 'walk%d.hdr' room.rad
cmp v.vf before.vf && cmp walk1.hdr before.vf || fail "a view was changed"
echo "-ab 0" >quick.opt
refused "is a file of options: --stats would" @quick.opt --stats=quick.opt \
    -o x.hdr room.rad
draw -o x.hdr --stats=run.json
refused "is the file of --estimate: --stats would" -vf v.vf \
    --estimate=run.json --stats=run.json -o x.hdr room.rad
mkdir -p "$XDG_CONFIG_HOME/radd"
: >"$XDG_CONFIG_HOME/radd/radsubmit.conf"
refused "is the configuration: -o would" -vf v.vf \
    -o "$XDG_CONFIG_HOME/radd/radsubmit.conf" room.rad
refused "is the scene: -o would" -vf v.vf -o room.rad room.rad

# files that the scene names, known when it is read
echo "f = 1;" >own.cal
cat room.rad >named.rad
cat >>named.rad <<'END'
void brightfunc dim 2 f own.cal 0 0
dim plastic grey 0 0 5 .5 .5 .5 0 0
grey sphere ball 0 0 4 1 1 1 .1
END
cp own.cal before.cal
refused "'own.cal' is a file of the scene: -z would" -vf v.vf -o x.hdr \
    -z own.cal named.rad
cmp own.cal before.cal || fail "the scene's file was changed"
"$top_builddir/radscene" freeze room.rad >frozen.oct
printf 'void instance it 1 frozen.oct 0 0\n' >within.rad
refused "'frozen.oct' is a file of the scene" -vf v.vf -o frozen.oct within.rad
expect 64 "'plain.hdr' is one of the pictures: --mean would" "raderr" \
    "$top_builddir/raderr" --mean=plain.hdr a.hdr plain.hdr

# --- options in a file ---

cat >commented.opt <<'END'
# what all pictures have
-ab 0 # no indirect light
-x 16 -y 12
#-o nowhere/x.hdr
END
# shellcheck disable=SC2086
"$radsubmit" --local --threads=1 @commented.opt -vf v.vf -o c.hdr room.rad \
    2>stderr || fail "comments: $(cat stderr)"
cmp c.hdr plain.hdr || fail "comments: another picture"

# standard files that are closed: nothing else gets their numbers
printf 'void glow g 0 0 4 1 1 1 0\ng bubble b 0 0 4 0 0 0 9\n' >closed.rad
closed="$radsubmit --local -vp 0 0 0 -vd 0 1 0 -x 8 -y 8"
$closed -o closed.hdr closed.rad <&- >&- 2>&- || fail "closed files: status $?"
$closed closed.rad 2>stderr | cmp - closed.hdr ||
    fail "a picture with closed files: $(cat stderr)"
$closed closed.rad >&- 2>stderr
[ $? -eq 74 ] || fail "closed standard output: $(cat stderr)"
grep -q "cannot write 'standard output'" stderr ||
    fail "closed standard output: $(cat stderr)"
"$radctl" --coordinator="$work/none" status <&- >&- 2>&-
[ $? -eq 69 ] || fail "radctl with closed files"
timeout 600 "$radcoord" --listen= --socket="$work/c.sock" --state="$work/c" \
    --ports-file="$work/c.ports" <&- >&- 2>&- &
until_true 10 test -s "$work/c.ports" || fail "a coordinator with closed files"
kill %% && wait

check_nothing_left outputs
finish
