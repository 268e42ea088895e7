#!/bin/sh
# radscene.sh - what radscene prints, its messages and its exit statuses
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
radscene=$top_builddir/radscene
unset RAYPATH

# expect STATUS TEXT COMMAND...: the command ends with that status, and its
# standard error has the text, or is empty if the text is
expect()
{
    status=$1 text=$2
    shift 2
    "$@" >out 2>err
    got=$?
    if [ "$got" -ne "$status" ] || { [ -s err ] && [ -z "$text" ]; } ||
        { [ -n "$text" ] && ! grep -qF -- "$text" err; }; then
        fail "$*: status $got, expected $status and '$text': $(cat err)"
    fi
}

# same TEXT: the last command printed exactly that
same()
{
    [ "$(cat out)" = "$1" ] || fail "printed: $(cat out)"
}

cat >good.rad <<'END'
# a ball under a lamp
void plastic grey 0 0 5 .5 .5 .5 0 0
void light lamp 0 0 3 10 10 10
void mixfunc unused 4 grey grey .5 . 0 0
grey sphere ball
0
0
4 0 0 1 1
!echo 'lamp ring top 0 0 8 0 0 4 0 0 -1 0 .5'
END

expect 0 '' $radscene check good.rad
same ''
expect 0 '' $radscene needs good.rad
same 'sphere
ring
light
plastic'
expect 0 '' $radscene info good.rad
same 'objects 5
surfaces 2
sources 1
bounds -1 -1 0  1 1 4
  sphere 1
  ring 1
  light 1
  plastic 1
  mixfunc 1'

# a frozen scene is the scene, by any name and from standard input
expect 0 '' $radscene info good.rad
mv out info
expect 0 '' $radscene freeze good.rad
mv out good.oct
expect 0 '' $radscene info good.oct
same "$(cat info)"
expect 0 '' sh -c "$radscene info - <good.oct"
same "$(cat info)"
expect 0 '' $radscene freeze good.oct
cmp out good.oct || fail "freeze changes an octree"
# an old one begins with the command
{ echo 'oconv -f good.rad' && sed 1d good.oct; } >old.oct
expect 0 '' $radscene info old.oct
same "$(cat info)"
expect 0 '' sh -c "$radscene info - <old.oct"
same "$(cat info)"
head -c 300 good.oct >cut.oct
expect 65 'cut.oct: truncated at byte 300' $radscene check cut.oct
head -c 5 good.oct >cut.oct
expect 65 'cut.oct: ' $radscene check cut.oct
expect 64 "octree 'good.oct' must be the only" $radscene check good.rad good.oct
expect 64 "octree 'good.oct' must be the only" $radscene check good.oct good.rad
[ "$(wc -l <err)" -eq 1 ] || fail "told twice"
printf '#?RADIANCE\nFORMAT=Radiance_octree\n\n\001\0370\0000\0000\0001\000a.rad\000' \
    >thawed.oct
expect 66 "thawed.oct: cannot find file 'a.rad'" $radscene check thawed.oct

# one that is not frozen is read from what it names, beside it or by command
printf 'grey sphere more 0 0 4 9 9 9 1\n' >more.rad
printf '#?RADIANCE\nFORMAT=Radiance_octree\n\n\001\0370\0000\0000\0001\000good.rad\000!sed s/grey/lamp/ more.rad\000\000\000\000\000\006\000' >thawed.oct
expect 0 '' $radscene info --commands thawed.oct
cp out six
same 'objects 6
surfaces 3
sources 2
bounds -1 -1 0  10 10 10
  sphere 2
  ring 1
  light 1
  plastic 1
  mixfunc 1'
# a command may write either kind, as for rpict; what goes wrong is told once
for made in '!cat good.oct' '!cat old.oct' "!$radscene freeze good.rad"; do
    expect 0 '' $radscene info "$made"
    same "$(cat info)"
done
expect 0 '' $radscene info '!cat more.rad |
    sed s/grey/void/' # the shell has all lines
expect 0 '' $radscene info --commands '!cat thawed.oct && yes | head -c 200000'
same "$(cat six)"
expect 77 "use --commands" $radscene info '!cat thawed.oct'
while IFS=@ read -r status told made; do
    expect "$status" "$told" $radscene check "$made"
    [ "$(wc -l <err)" -eq 1 ] || fail "told twice: $(cat err)"
done <<'END'
65@good.oct: truncated at byte 300@!head -c 300 good.oct
65@failed with exit status 3@!cat good.oct; exit 3
65@unknown data behind the octree@!cat good.oct; echo more
END
expect 64 "must be the only" $radscene check '!cat good.oct' good.rad
mkdir elsewhere
(cd elsewhere && $radscene freeze --commands ../thawed.oct) >frozen.oct ||
    fail "freeze from another folder"
expect 0 '' $radscene check frozen.oct
printf 'grey sphere most 0 0 4 9 9 9 1\n' >>more.rad
expect 65 'octree of 6 objects, but its scene files have 7: make it again' \
    $radscene check --commands thawed.oct

# one that holds itself ends, and the reason is told though the way there is long
printf 'void instance again 1 self.oct 0 0\n' >self.rad
printf '#?RADIANCE\nFORMAT=Radiance_octree\n\n\001\0370\0000\0000\0001\000self.rad\000\000\000\000\000\001\000' >self.oct
expect 65 'instances are nested more than 64 files deep' $radscene check self.rad

# whoever names an octree does not see its commands: in its own list, in a file
# that it names, in the octree of an instance
not_run()
{
    [ ! -e ran ] || fail "$1: a command of an octree was run"
    rm -f ran
}
printf '#?RADIANCE\nFORMAT=Radiance_octree\n\n\001\0370\0000\0000\0001\000!touch ran; cat more.rad\000\000\000\000\000\001\000' >listed.oct
printf 'void plastic grey 0 0 5 .5 .5 .5 0 0\n\n!touch ran\n' >runs.rad
printf '#?RADIANCE\nFORMAT=Radiance_octree\n\n\001\0370\0000\0000\0001\000runs.rad\000\000\000\000\000\001\000' >named.oct
printf 'void instance it 1 named.oct 0 0\n' >within.rad
for sub in check info needs freeze rays; do
    expect 77 "listed.oct: command 'touch ran; cat more.rad' of an octree" \
        $radscene $sub listed.oct
    expect 77 "runs.rad:3: command 'touch ran' of an octree is not run: use --commands" \
        $radscene $sub named.oct
    expect 77 "runs.rad:3: command 'touch ran' of an octree" \
        $radscene $sub within.rad
    not_run $sub
done
for scene in named.oct within.rad; do
    expect 77 "runs.rad:3: command 'touch ran' of an octree" \
        "$top_builddir/radsubmit" --local --dry-run $scene
    not_run "radsubmit $scene"
done
expect 0 '' $radscene info --commands named.oct
[ -e ran ] || fail "--commands runs none"
rm -f ran
expect 0 '' $radscene info runs.rad
[ -e ran ] || fail "the commands of a text are not run"
rm -f ran

# bad scenes
printf 'void plastic m\n0\nO\n5 1 1 1 0 0\n' >bad.rad
expect 65 'bad.rad:3: plastic' $radscene check bad.rad
# every error is told, also where reading found some
printf 'void plastic m 0 0 4 1 1 1 0\nwood sphere s 0 0 4 0 0 0 1\n%s\n%s\n%s' \
    'm spher s 0 0 1 1' 'm polygon p 0 0 4 1 2 3 4' \
    'm instance i 1 none.oct 0 0' >bad.rad
expect 65 "bad.rad:2: undefined modifier 'wood'" $radscene check bad.rad
for told in "bad.rad:1: plastic 'm'" "bad.rad:3: unknown type 'spher'" \
    "bad.rad:4: polygon 'p'" "bad.rad:5: instance 'i': cannot find file"; do
    expect 65 "$told" $radscene check bad.rad
done
printf '\n\nwood sphere s 0 0 4 0 0 0 1\n' >bad.rad
expect 65 "bad.rad:3: undefined modifier 'wood'" $radscene check bad.rad
printf 'void polygon p 0 0 4 0 0 0 1\n' >bad.rad
expect 65 "bad.rad:1: polygon 'p': expected at least 9 real arguments, got 4" \
    $radscene check bad.rad
printf 'void polygon p 0 0 4 0 0 0 1\nvoid ring r 0 0 8 0 0 0 0 0 1 -1 2\n' >bad.rad
expect 65 "bad.rad:1: polygon 'p'" $radscene check bad.rad
expect 65 "bad.rad:2: ring 'r': negative radius" $radscene check bad.rad
expect 65 "bad.rad:1: polygon 'p'" $radscene info bad.rad
head -c 100000 /dev/urandom >bad.rad
expect 65 'bad.rad:1: ' $radscene check bad.rad
expect 66 "cannot open 'none.rad'" $radscene check none.rad
expect 66 "cannot read '.'" $radscene check .
printf '!exit 3\n' >bad.rad
expect 65 "bad.rad:1: '!exit 3' failed with exit status 3" \
    $radscene check bad.rad

# what modifiers name is looked into, once a surface leads to it
use='p plastic m 0 0 5 1 1 1 0 0 m sphere s 0 0 4 0 0 0 1'
printf '\nvoid brightfunc p 2 nix(1) . 0 0\n%s\n' "$use" >bad.rad
expect 65 "bad.rad:2: brightfunc 'p': 'nix(1)': undefined function 'nix'" \
    $radscene check bad.rad
printf '\nvoid brightfunc p 2 Px none.cal 0 0\n%s\n' "$use" >bad.rad
expect 66 "bad.rad:2: brightfunc 'p': cannot find file 'none.cal'" \
    $radscene check bad.rad
# an octree's objects have no lines: what is the same for many is told once
for i in 1 2 3; do
    printf 'void brightfunc p 2 Px gone.cal 0 0\n%s\n' "$use"
done >bad.rad
echo '{ }' >gone.cal
$radscene freeze bad.rad >gone.oct || fail "freeze"
rm gone.cal
expect 66 "gone.oct: brightfunc 'p': cannot find file 'gone.cal'" \
    $radscene check gone.oct
[ "$(grep -c '^radscene: gone' err)" -eq 1 ] ||
    fail "told thrice"
expect 0 "" $radscene check --help

# what no surface uses is warned of, here and where it is rendered
cat >library.rad <<'END'
void mixfunc mixed 4 nowhere void .5 . 0 0
void plastic two 0 0 2 1 1
void brightfunc lost 2 Px none.cal 0 0
void plastic grey 0 0 5 .5 .5 .5 0 0
grey cone odd 0 0 8 0 0 0 0 0 1 1 -1
grey sphere ball 0 0 4 0 0 0 1
END
for told in "library.rad:1: mixfunc 'mixed': undefined modifier 'nowhere'; no" \
    "library.rad:2: plastic 'two': expected 5 real arguments, got 2; no" \
    "library.rad:3: brightfunc 'lost': cannot find file 'none.cal': RAYPATH is not set; no" \
    "library.rad:5: cone 'odd': radii of opposite sign: it is left out"; do
    expect 0 "radscene: warning: $told" $radscene check library.rad
done
[ "$(wc -l <err)" -eq 4 ] || fail "other warnings"
expect 0 "warning: library.rad:2: plastic 'two'" \
    $top_builddir/radsubmit --local -x 8 -y 8 -ab 0 -o none.hdr library.rad
for name in mixed two lost; do
    echo "$name sphere user 0 0 4 0 0 0 1" >user.rad
    $radscene check library.rad user.rad 2>err
    case $?:$(grep -v warning: err) in
    65:*"'$name'"* | 66:*"'$name'"*) ;;
    *) fail "$name, used: $(cat err)" ;;
    esac
done
# an octree's materials that its only copy replaces are not used either
printf '%s\n' 'void plastic bad 0 0 2 1 1' 'bad sphere s 0 0 4 0 0 0 1' >in.rad
printf '#?RADIANCE\nFORMAT=Radiance_octree\n\n\001\0370\0000\0000\0001\000in.rad\000\000\000\000\000\002\000' >in.oct
cover='void plastic grey 0 0 5 .5 .5 .5 0 0 grey instance i 1 in.oct 0 0'
echo "$cover" >covers.rad
expect 0 "plastic 'bad': expected 5 real arguments, got 2; no surface uses it" \
    $radscene check covers.rad
echo "$cover void instance j 1 in.oct 0 0" >covers.rad
expect 65 "plastic 'bad': expected 5 real arguments, got 2" \
    $radscene check covers.rad

mkfifo pipe.cal
for name in pipe.cal /dev/zero /; do
    printf '\nvoid brightfunc p 2 Px %s 0 0\n%s\n' $name "$use" >bad.rad
    expect 66 "bad.rad:2: brightfunc 'p': cannot find file '$name'" \
        timeout 600 $radscene check bad.rad
done
printf '\nvoid colorpict p 7 red green blue good.rad . Px Py 0 0\n%s\n' \
    "$use" >bad.rad
expect 65 "bad.rad:2: colorpict 'p': 'good.rad': picture: not a Radiance" \
    $radscene check bad.rad

# a spectrum's file comes along with the scene
printf 'void specfile dye 1 x.spc 0 0\ndye plastic p 0 0 5 1 1 1 0 0
p sphere s 0 0 4 0 0 0 1\n' >dye.rad
expect 66 "dye.rad:1: specfile 'dye': cannot find file 'x.spc'" \
    $radscene check dye.rad
echo '1 380 780 3 .2 .4 .6' >x.spc
expect 0 '' $radscene check dye.rad
expect 0 '' $radscene needs dye.rad
same 'sphere
plastic
specfile'
expect 0 '' $radscene freeze dye.rad
printf 'void mesh m 1 x.rtm 0 0\n' >mesh.rad
expect 66 "mesh.rad:1: mesh 'm': cannot find file 'x.rtm'" \
    $radscene freeze mesh.rad

# a mist that names what is no light
printf 'void light l 0 0 3 1 1 1\nl sphere lamp 0 0 4 0 0 9 1
void mist ok 2 lamp m>lamp 0 0\nok sphere a 0 0 4 0 0 0 1
void mist fog 2 lamp lmap 0 0\nfog sphere b 0 0 4 0 0 3 1\n' >fog.rad
expect 0 "warning: fog.rad:5: mist 'fog': no light source 'lmap'" \
    $radscene check fog.rad

# An interrupted radscene leaves no command running, however early the signal
# comes.  Dead processes may stay in the group for want of a parent.
printf '!echo $$ >pid; kill -TERM $PPID; sleep 1000 | sleep 1000\n' >slow.rad
runs()
{
    ps -eo pgid=,stat= |
        awk -v group="$1" '$1 == group && $2 !~ /^Z/ { n++ } END { exit !n }'
}
for i in 1 2 3 4 5 6 7 8 9 10; do
    $radscene check slow.rad
    status=$?
    [ $status -eq 143 ] || fail "SIGTERM: status $status"
    tries=0
    while runs "$(cat pid)"; do
        tries=$((tries + 1))
        [ $tries -lt 6000 ] && sleep .01 && continue
        fail 'a command is left'
        kill -s TERM -- "-$(cat pid)"
        break
    done
done

# wrong command lines
expect 64 'usage: radscene' $radscene
expect 64 'usage: radscene' $radscene chekc good.rad
expect 64 'no scene file' $radscene check
expect 64 'no scene file' $radscene check --
expect 64 'no scene file' $radscene rays --
cp good.rad ./-good.rad
expect 64 "unknown option '-good.rad'" $radscene check -good.rad
expect 0 '' $radscene check -- -good.rad
expect 0 '' $radscene info --commands -- -good.rad good.rad
expect 0 '' $radscene rays -ab 0 -- -good.rad </dev/null
expect 64 "unknown option '-x'" $radscene info -x good.rad
expect 64 "unknown option '-zz'" $radscene rays -zz good.rad
expect 64 "'-pXYZ': answers are red, green and blue" \
    $radscene rays -pXYZ good.rad
expect 64 "'-pc': answers are red" \
    $radscene rays -pc .64 .33 .3 .6 .15 .06 .3127 .329 good.rad
expect 0 '' $radscene --help
grep -q 'usage: radscene check' out || fail "--help: $(cat out)"
expect 0 '' $radscene --version
grep -q '^radscene (radd) [0-9]' out || fail "--version: $(cat out)"
expect 74 'cannot write' sh -c "$radscene needs good.rad >/dev/full"
expect 74 'cannot write' sh -c "$radscene --help >/dev/full"
expect 74 'cannot write' sh -c "$radscene freeze good.rad >/dev/full"

# more surfaces in one place than Radiance's octree takes
awk 'BEGIN { print "void plastic m 0 0 5 .5 .5 .5 0 0"
             for (i = 0; i < 600; i++)
                 print "m polygon p" i " 0 0 12 0 0 0 1 0 .1 1 1 .1 0 1 0" }' \
    >stack.rad
expect 0 'full cubes of the octree lack' \
    sh -c "$radscene freeze stack.rad >stack.oct"
[ "$(wc -l <err)" -eq 1 ] || fail 'said more than once'
expect 0 '' $radscene check stack.oct

# functions without a value are told of once each
cat >log.rad <<'END'
void brightfunc one 2 log(-Pz) . 0 0

one mixfunc two 4 void void 1/(Px-9) . 0 0
two glow g 0 0 4 1 1 1 0
g sphere ball 0 0 4 0 0 0 9
END
printf '20 0 1 -1 0 0\n20 0 2 -1 0 0\n20 0 0 -1 0 0\n' >rays
expect 0 "warning: log.rad:1: brightfunc 'one': no value in 3 places" \
    sh -c "$radscene rays -ab 0 log.rad <rays"
expect 0 "warning: log.rad:3: mixfunc 'two': no value in 1 place " \
    sh -c "$radscene rays -ab 0 log.rad <rays"
[ "$(wc -l <err)" -eq 2 ] || fail 'said more than twice'

# a BSDF whose up vector is its normal is black, and told of
cat >up.rad <<END
void BSDF window 6 0 $scenes/bsdf_matrix.xml 0 1 0 .
0
0
void glow g 0 0 4 1 1 1 0
g source sky 0 0 4 0 0 1 360
window polygon pane 0 0 12 -9 5 -9 9 5 -9 9 5 9 -9 5 9
END
printf '0 0 0 0 1 0\n0 9 1 0 -1 0\n0 0 0 0 -1 0\n' >rays
expect 0 "warning: up.rad:1: BSDF 'window': no way up, or no value, in 2 places" \
    sh -c "$radscene rays -ab 0 up.rad <rays"
same '0 0 0
0 0 0
1 1 1'

# rays: into the ball, and to the sky
printf '0 0 -5 0 0 1\n0 0 9 0 0 1\n' >rays
expect 0 '' sh -c "$radscene rays -ab 0 -av 1 1 1 good.rad <rays"
same '0.5 0.5 0.5
0 0 0'

# ambient records: kept for the next run, refused where they do not fit
cat >cell.rad <<'END'
void plastic grey 0 0 5 .5 .4 .3 0 0
void light lamp 0 0 3 9 9 9
lamp sphere a 0 0 4 0 0 .5 .1
grey bubble b 0 0 4 0 0 0 1
END
printf '0 .2 -.7 0 0 1\n.2 .2 -.7 0 0 1\n' >rays
amb='-I -ab 2 -aa .2 -ad 64 -as 0'
expect 0 '' sh -c "$radscene rays $amb -af cell.amb cell.rad <rays"
cp cell.amb first.amb
mv out first.out
expect 0 '' sh -c "$radscene rays $amb -af cell.amb cell.rad <rays"
cmp cell.amb first.amb && cmp out first.out || fail "other values by -af"
expect 65 'cell.amb: was made with other options: -ad differs' \
    sh -c "$radscene rays $amb -ad 128 -af cell.amb cell.rad <rays"
sed 's/0 0 0 1$/0 0 0 2/' cell.rad >other.rad
expect 65 'cell.amb: belongs to another scene' \
    sh -c "$radscene rays $amb -af cell.amb other.rad <rays"
expect 65 'other.rad: not a file of ambient records' \
    sh -c "$radscene rays $amb -af other.rad cell.rad <rays"
expect 64 'there are no ambient records without' \
    sh -c "$radscene rays -I -af cell.amb cell.rad <rays"
cmp cell.amb first.amb || fail "records of what was refused"
# an alias is told of once, by the name that is not there
echo 'void alias b foo' >alias.rad
expect 65 "alias.rad:1: alias 'b' of undefined modifier 'foo'" \
    $radscene check alias.rad
echo 'void alias b void' >void.rad
expect 65 "void.rad:1: alias 'b' of nothing" $radscene check void.rad
for f in alias.rad void.rad; do
    [ "$($radscene check $f 2>&1 | grep -c .)" -eq 1 ] ||
        fail "of $f: $($radscene check $f 2>&1)"
done
finish
