#!/bin/sh
# submit_bad_input.sh - what cannot be rendered is refused with the right exit
# status, a message that says where, and nothing left behind
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

room=$scenes/room.rad
printf 'void plastic p\n0\n0\n' >short.rad # arguments are missing
printf 'void plastic white 0 0 5 .5 .5 .5 0 0\n\nwhite nonsense x 0 0 0\n' \
    >line3.rad
printf 'wood sphere s 0 0 4 0 0 0 1\n' >unknown.rad
printf 'void plastic p 0 0 5 .5 .5 .5 0 0\np polygon q\n0\n0\n4 1 2 3 4\n' \
    >four.rad
# random bytes, the same ones each time
awk 'BEGIN { srand(7); for (i = 0; i < 102400; i++)
    printf "%c", 1 + int(rand() * 255) }' >random.rad
cp random.rad random.oct
"$top_builddir/radscene" freeze "$room" >whole.oct ||
    fail "radscene freeze"
head -c $(($(wc -c <whole.oct) / 2)) whole.oct >truncated.oct
printf 'rvu -vp 1 2\n' >bad.vf
printf '\nvoid brightfunc f 2 nix(Px) . 0 0\nf glow g 0 0 4 1 1 1 0
g sphere s 0 0 4 0 0 0 1\n' >function.rad

r="$radsubmit --local -x 16 -y 16 -o out.hdr"
expect 66 "missing.rad" "missing file" $r missing.rad
expect 66 "missing.oct" "missing octree" $r missing.oct
expect 65 "line3.rad:3" "syntax error in line 3" $r line3.rad
expect 65 "short.rad" "too few arguments" $r short.rad
expect 65 "unknown.rad:1" "unknown modifier" $r unknown.rad
grep -q wood stderr || fail "unknown modifier: not named"
expect 65 "function.rad:2: brightfunc 'f'" "a function that is not there" \
    $r function.rad
expect 65 "four.rad:2" "polygon with 4 numbers" $r four.rad
expect 65 "truncated.oct" "truncated octree" $r truncated.oct
expect 65 "random.rad" "random bytes" $r random.rad
expect 65 "random.oct" "random bytes as an octree" $r random.oct
expect 65 "bad.vf" "bad view file" $r -vf bad.vf "$room"
expect 66 "missing.vf" "missing view file" $r -vf missing.vf "$room"
expect 66 "cannot read the view file" "a folder for a view" $r -vf . "$room"
expect 64 "no photon maps" "an option of rpict that is not there" \
    $r -ap map "$room"
expect 64 "'-e'" "an expression" $r -e 'a:3' "$room"
expect 64 "'-pm'" "a blur from an unknown view" \
    $r -pm .1 -S 2 -o a%d.hdr "$room"
expect 66 "names.none" "a file of names missing" $r -aE names.none "$room"
expect 73 "none/err" "the error file's folder missing" \
    $r -e none/err -o out.hdr "$room"
expect 64 "-x" "-x abc" $r -x abc "$room"
expect 64 "of 16 by 0 pixels" "a view too flat for any row" $r -vh 179.9 "$room"
expect 66 "radsubmit: cannot open 'none.json'" "no such statistics" \
    $r --estimate=none.json "$room"
expect 64 "stripes" "a partition that is not there" \
    $r --partition=stripes "$room"
expect 64 "--detach" "--detach without a coordinator" \
    "$radsubmit" --local --detach "$room"
expect 64 "--detach and -o exclude each other" "--detach with a picture" \
    "$radsubmit" --detach -o - "$room"
for option in -z --stats --preview; do
    expect 64 "'-' is a name for -o alone" "$option to standard output" \
        $r $option - "$room"
done
expect 64 "--local" "workers for a coordinator" \
    "$radsubmit" --coordinator=127.0.0.1:1 --workers=2 -o out.hdr "$room"
expect 64 "'out.jpg'" "a format that is not written" \
    "$radsubmit" --local -o out.jpg "$room"
expect 64 "'p.hdr'" "a preview that is no PNG" $r --preview=p.hdr "$room"
expect 64 "-o and -z" "two outputs of one name" $r -z out.hdr "$room"
expect 64 "-o and --stats" "two outputs of one name, said otherwise" \
    $r --stats="$work/out.hdr" "$room"
cp "$room" mine.rad
expect 64 "'mine.rad' is the scene" "the scene's own file as the picture" \
    "$radsubmit" --local -o mine.rad mine.rad
cmp -s mine.rad "$room" || fail "the scene was overwritten"
expect 64 "radsubmit --help" "nothing at all" "$radsubmit"
expect 0 "" "two outputs that go nowhere" "$radsubmit" --local -x 4 -y 4 \
    -o /dev/null -z /dev/null "$room"
expect 0 "" "a strange name whose format is said" "$radsubmit" --local -x 4 \
    -y 4 --format=hdr -o out.jpg "$room"
rm out.jpg
expect 65 "64600 pixels is too wide" "base lines that fit no message" \
    "$radsubmit" --local --workers=2 --partition=scanbar -x 64600 -y 30 -pa 0 \
    -ps 3 -z out.z -o out.hdr "$room"
expect 73 "no/out.hdr" "output folder missing" \
    "$radsubmit" --local -o no/out.hdr "$room"
expect 73 "no/d.z" "depth folder missing" $r -z no/d.z "$room"
expect 73 "no/s.json" "statistics folder missing" \
    $r --stats=no/s.json "$room"
expect 69 "127.0.0.1:1" "coordinator not there" \
    "$radsubmit" --coordinator=127.0.0.1:1 --wait=1 -o out.hdr "$room"
expect 69 "$work/no.sock" "socket not there" \
    "$radsubmit" --coordinator="$work/no.sock" --wait=0 -o out.hdr "$room"
expect 77 "192.0.2.1" "coordinator elsewhere" \
    "$radsubmit" --coordinator=192.0.2.1:7420 --wait=0 -o out.hdr "$room"
expect 69 "no.sock" "radctl without a coordinator" \
    "$radctl" --coordinator="$work/no.sock" status
# what can only be dark is told, what may be bright is not
printf 'void plastic p 0 0 5 .5 .5 .5 0 0\np sphere s 0 0 4 0 0 0 1\n' >dark.rad
expect 0 "warning: no light sources found" "no light" \
    "$radsubmit" --local -x 4 -y 4 -o /dev/null dark.rad
printf 'void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n' >sky.rad
expect 0 "warning: no light sources found" "a sky without indirect light" \
    "$radsubmit" --local -x 4 -y 4 -ab 0 -o /dev/null sky.rad
expect 0 "" "a sky" "$radsubmit" --local -x 4 -y 4 -ab 1 -o /dev/null sky.rad
grep warning stderr && fail "the sky gives light"
expect 0 "warning: the picture is black" "a view past the room" \
    "$radsubmit" --local -x 4 -y 4 -vp 2 1.5 9 -vd 0 1 0 -o b.hdr "$room"
printf 'rview -vp 2 1.5 9 -vd 0 1 0\nrview -vp 2 1 1 -vd 0 1 0\n' >two.vf
expect 0 "" "a dark picture and another" "$radsubmit" --local -x 4 -y 4 \
    -S 1 --views=two.vf -o two%d.hdr "$room"
grep "warning: .* black" stderr && fail "one picture has light"
printf '# nothing\n!echo\n' >empty.rad
expect 0 "warning: the scene has no surface" "nothing at all" \
    "$radsubmit" --local -x 4 -y 4 -o /dev/null empty.rad
grep "warning: .*empty.rad:2 (!echo): empty file" stderr ||
    fail "nothing comes of the command"
grep "warning: .*empty.rad: empty file" stderr || fail "nor of the file"
printf 'void plastic p 0 0 5 1 1 1 0 0\nvoid glow g 0 0 4 1 1 1 0
void mixfunc m 4 p g .5 . 0 0\nm sphere s 0 0 4 0 0 0 1\n' >mixed.rad
expect 0 "" "a mixture that shines" \
    "$radsubmit" --local -x 4 -y 4 -o /dev/null mixed.rad
grep "warning: no light" stderr && fail "it is not dark"
expect 65 "nothing came on standard input" "a pipe whose writer failed" \
    "$radsubmit" --local -x 4 -y 4 -o /dev/null -
expect 64 "unknown option '-output'" "a word that begins as rtrace's -o does" \
    "$radsubmit" --local -output a.hdr "$room"
expect 64 "unknown option '-fov'" "a word that begins as rtrace's -f does" \
    "$radsubmit" --local -fov 60 "$room"
expect 69 "--keys" "keys of no coordinator" "$radctl" key list
expect 64 "out.tif" "a format that is not written, of radctl" \
    "$radctl" --coordinator="$work/no.sock" fetch 1f -o out.tif
expect 64 "frobnicate" "unknown command" "$radctl" frobnicate
# what is wrong with the command line is said before anybody is asked
while read -r words; do
    # shellcheck disable=SC2086 # words are words
    expect 64 "" "radctl $words" "$radctl" --coordinator="$work/no.sock" $words
done <<EOF
priority 1f
priority 1f 101
priority 1f 1x
key drop user:a
key add
key add ana
key add user:a:k1
key add user:a --expires=2001-01-01
key add user:a --state=valid
key retire ana
key list user:a
key list --expires=2099-01-01
key list --state=idle
enroll ws01 --output=out
enroll ws/01 --output=out
fetch 1f --json
fetch 1f -o x.hdr --bits=16
status --limit=1
workers --user=ana
cancel 1f --user=ana
top
EOF
expect 73 "no such folder" "no place for what is fetched" \
    "$radctl" --coordinator="$work/no.sock" fetch 1f -o no/x.hdr
expect 64 "'frobnicate'" "unknown command of radscene" \
    "$top_builddir/radscene" frobnicate "$room"
[ ! -e out.hdr ] || fail "a picture was written"
check_nothing_left "after bad input"
finish
