#!/bin/sh
# submit_embedded.sh - pictures of radsubmit's own cluster: complete, the same
# however the work was shared, and nothing left behind
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

size="-x 120 -y 90"
view="-vf $scenes/room.vf $size"
room=$scenes/room.rad

# render OUT OPTIONS...
render()
{
    out=$1
    shift
    # shellcheck disable=SC2086 # options are words
    "$radsubmit" --local $view -ab 0 -o "$out" "$@" "$room" 2>stderr || {
        fail "radsubmit $*: exit status $?"
        cat stderr
    }
}

same()
{
    cmp "$1" "$2" || fail "$3"
}

# one window is what one loop over the picture makes
render one.hdr --workers=1 --threads=1
# shellcheck disable=SC2086
"$top_builddir/tests/tools/seqpict" $view -ab 0 -o seq.hdr "$room" 2>stderr ||
    fail "seqpict: $(cat stderr)"
# the pixels of a picture: what follows its resolution line
body() { sed '1,/^-Y /d' "$1"; }
body one.hdr >one.body
body seq.hdr >seq.body
[ -s one.body ] || fail "no pixels in one.hdr"
same one.body seq.body "one worker's picture is not the sequential one"

# one that comes late has its part, where parts are laid out at the start
mkdir programs
cp "$radsubmit" programs/radsubmit
cat >programs/radd <<END
#!/bin/sh
case "\$*" in *--name=local-2*) sleep .4 ;; esac
exec "$radd" "\$@"
END
cat >programs/radcoord <<END
#!/bin/sh
exec "$radcoord" "\$@"
END
chmod +x programs/radd programs/radcoord
# shellcheck disable=SC2086
programs/radsubmit --local $view -ab 0 --workers=3 --threads=1 \
    --partition=static --no-balance --stats=late.json -o late.hdr "$room" \
    2>stderr || fail "a late worker: $(cat stderr)"
body late.hdr >late.body
same one.body late.body "a late worker changes the picture"
python3 - <<'END' || fail "one that came late got nothing"
import json
s = json.load(open("late.json"))
assert [w["units"] for w in s["workers"]] == [1, 1, 1], s["workers"]
END

# a worker starts while the coordinator does, and finds its socket
cat >programs/radd <<END
#!/bin/sh
: >radd.begun
exec "$radd" "\$@"
END
cat >programs/radcoord <<END
#!/bin/sh
for i in \$(seq 500); do [ -e radd.begun ] && exec "$radcoord" "\$@"; sleep .02; done
END
# shellcheck disable=SC2086
programs/radsubmit --local $view -ab 0 --workers=1 -o both.hdr "$room" \
    2>stderr || fail "no worker while the coordinator starts: $(cat stderr)"
body both.hdr >both.body
same one.body both.body "a coordinator that comes late changes the picture"
cat >programs/radcoord <<END
#!/bin/sh
exec "$radcoord" "\$@"
END

# a large file is linked into the folders of all, and makes the same picture
awk 'BEGIN {
    print "2 0 1 500 0 1 500"
    for (i = 0; i < 250000; i++) printf "%.6f ", i * i % 991 / 991
}' >large.dat
cat >large.rad <<'END'
void brightdata table 5 noop large.dat . Px Py 0 0
table glow shines 0 0 4 1 1 1 0
shines polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0
END
flat="-vtl -vp .5 .5 1 -vd 0 0 -1 -vu 0 1 0 -vh 1 -vv 1 -x 40 -y 40 -ab 0"
cat >programs/radd <<END
#!/bin/sh
tries=0
until find "$work"/radsubmit.*/cache-1/files -size +1000k -links 3 |
    grep -q . || [ \$tries -ge 100 ]; do
    tries=\$((tries + 1))
    sleep .1
done
echo \$tries >tries
exec "$radd" "\$@"
END
# shellcheck disable=SC2086
programs/radsubmit --local $flat --workers=1 -o large.hdr large.rad \
    2>stderr || fail "a large file: $(cat stderr)"
[ "$(cat tries)" -lt 100 ] || fail "the large file is not linked"
# shellcheck disable=SC2086
"$top_builddir/tests/tools/seqpict" $flat -o large-seq.hdr large.rad 2>stderr ||
    fail "seqpict, a large file: $(cat stderr)"
body large.hdr >large.body
body large-seq.hdr >large-seq.body
same large.body large-seq.body "a large file makes another picture"

# 64 windows, any number of workers
render w11.hdr --partition=window --windows=64 --workers=1 --threads=1
render w31.hdr --partition=window --windows=64 --workers=3 --threads=1
render w22.hdr --partition=window --windows=64 --workers=2 --threads=2 \
    --order=random
render w12.hdr --order=backward --windows=64 --threads=1
render only.hdr --order=backward --threads=1 --stats=only.json
same w11.hdr w12.hdr "the other order changes the picture"
grep -q '"partition": *"window"' only.json || fail "--order asks for no windows"
same w11.hdr w31.hdr "3 workers change the picture"
same w11.hdr w22.hdr "2 workers of 2 threads change the picture"
[ "$(wc -l <stderr)" -eq 2 ] || fail "more than id and end are said: $(cat stderr)"
grep -qE '^radsubmit: job [0-9a-f]{32}$' stderr || fail "no job id is said"

# what is taken otherwise than it was said is told, and nothing else
render ps.hdr -ps 40 --threads=1
grep -q 'warning: -ps 40 .* taken as 16' stderr || fail "-ps 40: $(cat stderr)"
[ "$(wc -l <stderr)" -eq 3 ] || fail "-ps 40 says more: $(cat stderr)"
render ps.hdr -ps 0 --threads=1
[ "$(wc -l <stderr)" -eq 2 ] || fail "-ps 0 is told of: $(cat stderr)"
render ps.hdr -ae lamp -ai wall -pm .5 --threads=1
grep -q 'warning: -ai and -ae exclude each other, and the last' stderr ||
    fail "two lists: $(cat stderr)"
grep -q 'warning: -pm without -S' stderr || fail "-pm: $(cat stderr)"
render ps.hdr -w- -ae lamp -ai wall -pm .5 --threads=1
[ "$(wc -l <stderr)" -eq 2 ] || fail "-w- warns: $(cat stderr)"
render ps.hdr -ai lamp -ai wall -pm 0 --threads=1
[ "$(wc -l <stderr)" -eq 2 ] || fail "one list is told of: $(cat stderr)"

# a function that has no value everywhere is told of once, with its place
cat >log.rad <<'END'
void brightfunc half
2 'if(Px,log(0),1)' .
0
0

void brightfunc fine 2 'if(Px,2,1)' . 0 0
fine glow g 0 0 4 1 1 1 0
half glow h 0 0 4 1 1 1 0
h polygon seen 0 0 12 -9 5 -9 9 5 -9 9 5 9 -9 5 9
g polygon aside 0 0 12 -9 -5 -9 9 -5 -9 9 -5 9 -9 -5 9
END
"$radsubmit" --local -vp 0 0 0 -vd 0 1 0 -vh 45 -vv 45 -x 20 -y 20 -ps 1 \
    -pj 0 -ab 0 --threads=2 --stats=log.json -o log.hdr log.rad 2>stderr ||
    fail "log.rad: exit status $?"
grep -q "warning: log.rad:1: brightfunc 'half': no value in 200 places" stderr ||
    fail "log(0) is not told: $(cat stderr)"
[ "$(grep -c "no value" stderr)" -eq 1 ] ||
    fail "log(0) is told more than once: $(cat stderr)"

# where it goes
"$radsubmit" --local $view -ab 0 --threads=1 "$room" >stdout.hdr 2>stderr
same stdout.hdr one.hdr "standard output and -o differ"
render out.png --oversample=1 --threads=1 -z out.z --stats=stats.json --preview=preview.png
head -c 8 out.png | od -An -c | grep -q 'P   N   G' || fail "out.png is no PNG"
cmp out.png preview.png || fail "the last preview is not the picture"
[ "$(wc -c <out.z)" -eq $((120 * 90 * 4)) ] || fail "out.z has not a float a pixel"
render hdr.png --threads=1 --format=hdr
same hdr.png one.hdr "--format=hdr does not overrule the suffix"
python3 - <<'END' || fail "stats.json is not as it should be"
import json
s = json.load(open("stats.json"))
assert s["picture"] == {"width": 120, "height": 90, "frames": 1}, s["picture"]
assert s["totals"]["primary_rays"] > 0
assert s["totals"]["rays"] >= s["totals"]["primary_rays"]
assert s["time"]["wall_s"] >= s["time"]["render_s"] >= 0
assert len(s["workers"]) == 1 and len(s["units"]) >= 1
assert sum(u["width"] * u["height"] for u in s["units"]) == 120 * 90
END

# six pixels that cannot be are black, and told with the first of them, however
# the work was shared
cat >hot.rad <<'END'
void glow hot 0 0 4 1e39 1 1 0
hot polygon p 0 0 12 .11 .51 0 .39 .51 0 .39 .69 0 .11 .69 0
END
for workers in 1 2; do
    "$radsubmit" --local -vtl -vp .5 .5 1 -vd 0 0 -1 -vu 0 1 0 -vh 1 -vv 1 \
        -x 10 -y 10 -ps 1 -pj 0 --workers=$workers --threads=2 --windows=9 \
        --stats=hot.json -o hot.hdr hot.rad 2>stderr || fail "$(cat stderr)"
    grep -q 'warning: 6 pixels have radiance that is negative or no number, which is black; first: frame 0, column 1, row 3$' \
        stderr || fail "black pixels are not told of: $(cat stderr)"
    [ "$(grep -c "have radiance" stderr)" -eq 1 ] ||
        fail "said more than once: $(cat stderr)"
    ! grep "picture is black" stderr || fail "as if that were not known"
    grep -q '"nan_pixels": 6,' hot.json || fail "not in the statistics"
done

# nor are they lost where columns of a bar are lent to who has nothing else; what
# is traced ahead for nothing may count as well
cat >slow.cal <<'END'
f(x) : if(x-.5, f(x-1)+f(x-1), 1);
slow = if(-Py, f(15), 1);
END
cat >slow.rad <<'END'
void brightfunc pat 2 slow slow.cal 0 0
pat glow hot 0 0 4 1e39 1 1 0
hot sphere ball 0 0 4 0 0 0 3
END
least=0
for share in "--workers=1" "--workers=8 --partition=scanbar" "--workers=6"; do
    # shellcheck disable=SC2086 # words
    "$radsubmit" --local $share --threads=1 -vp 0 -9 0 -vd 0 1 0 -vu 0 0 1 \
        -vh 40 -vv 30 -x 96 -y 60 -ps 4 -pt .05 -pj 0 --stats=hot.json \
        -o hot.hdr slow.rad 2>stderr || fail "$(cat stderr)"
    n=$(sed -n 's/.*"nan_pixels": \([0-9]*\).*/\1/p' hot.json)
    [ "$least" -gt 0 ] || least=$n
    [ "$n" -gt 0 ] && [ "$n" -ge "$least" ] ||
        fail "$share: $n black pixels, of $least"
done

# an animation: two views, two pictures, the first that of the still where
# nothing is random
render still.hdr --threads=1 -pj 0 -ss 0
printf '%s\n%s\n' "$(cat "$scenes/room.vf")" "rvu -vh 40" |
    "$radsubmit" --local $size -ab 0 -pj 0 -ss 0 --threads=1 -S 7 -o 'f%03d.hdr' "$room" \
        2>stderr || fail "animation: $(cat stderr)"
[ -s f008.hdr ] || fail "no second frame"
body f007.hdr >f007.body
body still.hdr >still.body
same f007.body still.body "an animation's first frame is not the still"

# what is left of it has an exposure of its own, and says so
rest() # OPTION...
{
    printf '%s\n%s\n' "$(cat "$scenes/room.vf")" "rvu -vh 40" |
        "$radsubmit" --local $size -ab 0 --threads=1 -S 7 --no-clobber \
            -o 'p%d.png' "$@" "$room" 2>stderr || fail "rest: $(cat stderr)"
}
rest
grep -q warning stderr && fail "all frames: $(cat stderr)"
rm p8.png && rest
grep -q 'exposure is that of the first frame rendered now' stderr ||
    fail "the rest: $(cat stderr)"
rm p8.png && rest --exposure=.5
grep -q warning stderr && fail "the rest, exposure given: $(cat stderr)"

# with nothing kept between frames they are the same, one after the other
for partition in window scanbar auto; do
    { cat "$scenes/room.vf" && echo "rvu -vh 40" && echo "rvu -vh 60"; } |
        "$radsubmit" --local $size -ab 0 -pj 0 -ss 0 --workers=2 --threads=1 \
            --partition=$partition --fresh-frames --stats=fresh.json -S 7 \
            -o 'g%03d.hdr' "$room" 2>stderr ||
        fail "fresh frames, $partition: $(cat stderr)"
    for i in 007 008; do
        body f$i.hdr >f$i.body
        body g$i.hdr >g$i.body
        [ $partition = window ] ||
            same f$i.body g$i.body "fresh frame $i, $partition"
    done
    [ -s g009.hdr ] || fail "fresh frames, $partition: the last is missing"
    rm g*.hdr
done

check_nothing_left "after all of them"

# without the daemons it is told what to do
mkdir lone
cp "$radsubmit" lone
# shellcheck disable=SC2086
expect 69 "'radcoord' is not installed here: name a coordinator" "no daemons" \
    env PATH=/usr/bin:/bin lone/radsubmit --local $view -o lone.hdr "$room"
finish
