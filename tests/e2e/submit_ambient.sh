#!/bin/sh
# submit_ambient.sh - radsubmit -af: ambient values of a whole cluster in a file,
# and from it
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

radscene=$top_builddir/radscene
cp "$scenes/room.rad" room.rad
room=room.rad
light="-ab 1 -aa .25 -ar 16 -ad 32 -as 0"
view="-vf $scenes/room.vf -x 60 -y 45 $light"

# submit W OPTIONS...: with so many workers; statistics in $w.json
submit()
{
    w=$1
    shift
    "$radsubmit" --local --workers="$w" --threads=1 --stats="$w.json" \
        -o out.hdr "$@"
}

# a first run of three workers makes the file, a second one has it all
# shellcheck disable=SC2086 # options are words
{
    submit 3 $view -af room.amb $room 2>err || fail "first: $(cat err)"
    made=$(total 3.json ambient_values)
    [ "$made" -gt 100 ] || fail "only $made values"
    kept=$(records room.amb)
    [ "$kept" -ge "$made" ] || fail "$made values, in the file $kept"
    cp room.amb first.amb
    submit 1 $view -af room.amb $room 2>err || fail "second: $(cat err)"
    again=$(total 1.json ambient_values)
    # but what tiles left to the picture, having traced their rays
    [ "$again" -le $((made / 5)) ] || fail "$made values, and then $again"
    [ "$(records room.amb)" = $((kept + again)) ] || fail "lost or doubled"
    cmp -n "$(wc -c <first.amb)" room.amb first.amb || fail "the old ones differ"
    rm -f one.amb
    submit 1 $view -af one.amb $room 2>err || fail "one: $(cat err)"
    [ "$(records one.amb)" = "$(total 1.json ambient_values)" ] ||
        fail "one worker: $(records one.amb), $(grep ambient_values 1.json)"
    cmp one.amb first.amb || fail "one worker makes another file than three"

    # a file that has it all, and two workers that share: nothing travels twice
    submit 2 $view -af room.amb $room 2>err || fail "third: $(cat err)"
    [ "$(total 2.json ambient_received)" -le $((made / 20)) ] ||
        fail "what was in the file travelled: $(grep ambient_ 2.json)"
    [ "$(total 2.json ambient_redundant)" -le $((made / 20)) ] ||
        fail "what was in the file counts as redundant"

    # of what is not shared every worker's are kept
    submit 2 $view --no-share -af alone.amb $room 2>err || fail "$(cat err)"
    [ "$(records alone.amb)" -ge "$(total 2.json ambient_values)" ] ||
        fail "--no-share: $(records alone.amb), $(grep ambient_values 2.json)"

    # an animation begins with the file and adds to it
    printf 'rvu -vtv -vp 2 .15 1.3 -vd 0 1 %s -vu 0 0 1 -vh 75 -vv 60\n' \
        -.12 -.1 >views
    walk()
    {
        "$radsubmit" --local --threads=1 --stats=walk.json -S 1 \
            --views=views -x 60 -y 45 $light -o walk%d.hdr "$@" $room 2>err ||
            fail "animation $*: $(cat err)"
        total walk.json ambient_values
    }
    for how in --threads=1 --fresh-frames; do
        cp first.amb walk.amb
        without=$(walk $how)
        with=$(walk $how -af walk.amb)
        [ "$with" -le $((without - made * 3 / 4)) ] ||
            fail "animation $how: $with, and without a file $without"
        [ "$(records walk.amb)" = $((kept + with)) ] ||
            fail "animation $how: $with made, $(records walk.amb) kept"
    done

    # radscene knows the file, and radsubmit that of radscene
    printf '2 1 0 0 0 1\n' >rays
    "$radscene" rays -I $light -af room.amb $room <rays >out ||
        fail "radscene does not take the file"
    rm -f small.amb
    "$radscene" rays -I $light -af small.amb $room <rays >out
    submit 1 $view -af small.amb $room 2>err || fail "of radscene: $(cat err)"

    # what does not fit is refused, and stays
    cp first.amb room.amb
    expect 65 'room.amb: was made with other options: -ad differs' options \
        "$radsubmit" $view -ad 64 -af room.amb -o x.hdr $room
    printf 'void plastic p 0 0 5 .5 .5 .5 0 0\np sphere s 0 0 4 0 0 9 .1\n' |
        cat $room - >other.rad
    expect 65 'room.amb: belongs to another scene' scene \
        "$radsubmit" $view -af room.amb -o x.hdr other.rad
    head -c "$(($(wc -c <first.amb) - 1))" first.amb >cut.amb
    expect 65 'cut.amb: ends in the middle of a record' truncated \
        "$radsubmit" $view -af cut.amb -o x.hdr $room
    cp $room scene.amb
    expect 65 'scene.amb: not a file of ambient records' 'no records' \
        "$radsubmit" $view -af scene.amb -o x.hdr $room
    expect 64 'is the scene: -af would change it' 'the scene' \
        "$radsubmit" $view -af $room -o x.hdr $room
    expect 73 "no-folder/x.amb" 'no folder' \
        "$radsubmit" $view -af no-folder/x.amb -o x.hdr $room
    # Radiance's names no scene, so only places outside tell
    printf 'void plastic p 0 0 5 .5 .5 .5 0 0\np sphere s 0 0 4 0 0 0 .1\n' \
        >tiny.rad
    {
        printf '#?RADIANCE\nNCOMP=3\nFORMAT=Radiance_ambval\n\n\002\061'
        printf '\000\177\377\377\377\000'             # level 0, weight 1
        printf '\177\377\377\377\011\000\000\000\000\000\000\000\000\000\000'
        printf '\0\0\0\030\0\0\0\060'                 # directions
        printf '\177\377\377\377\000\177\377\377\377\000'
        printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0'
        printf '\0\0\0\0\200\200\200\200'
    } >far.amb
    [ "$(LC_ALL=C sed '1,/^$/d' far.amb | wc -c)" = 69 ] || fail "far.amb"
    expect 65 'no ambient record of 1 fits the scene' 'outside the scene' \
        "$radsubmit" --local $view -af far.amb -o x.hdr tiny.rad
    cmp room.amb first.amb || fail "a refused file was changed"

    # no room for the new file: the old one stays; far fewer records before
    rm -f full.amb
    submit 1 $view -x 4 -y 3 -af full.amb $room 2>err || fail "$(cat err)"
    cp full.amb before.amb
    blocks=$(($(wc -c <full.amb) / 512 + 250))
    (
        trap '' XFSZ
        ulimit -f $blocks
        submit 1 $view -ps 1 -af full.amb $room 2>err
    ) && fail "no room, and nothing was said"
    grep -qi 'full.amb' err || fail "no room: $(cat err)"
    cmp full.amb before.amb || fail "no room: the old file is gone"
    ls ./*.amb.* ./.*.amb* 2>/dev/null && fail "no room: something is left"

    # a room in large surroundings: what is shown decides, unless -ar or a file
    # of values does
    { cat $room; echo 'wall ring ground 0 0 8 2 2 -9 0 0 1 0 1e6'; } >site.rad
    site="$radsubmit --local --workers=1 -vf $scenes/room.vf -x 9 -y 9 -ad 16"
    $site -ab 1 -o site.hdr site.rad 2>err || fail "site: $(cat err)"
    grep -q 'surroundings' err && fail "a warning of nothing: $(cat err)"
    times=$(LC_ALL=C sed -n 's/.* --surroundings \([0-9]*\).*/\1/p' site.hdr)
    grep -aq -- "-ar $((64 * times)) " site.hdr ||
        fail "-ar does not go by what is shown: $(sed '/^$/q' site.hdr)"
    expect 0 "-ar $((16 * times)) suits that" 'a coarse -ar' \
        $site -ab 1 -ar 16 -o x.hdr site.rad
    expect 0 "--surroundings=$times suits that" 'views of all sizes' \
        $site -ab 1 -af site.amb -o x.hdr site.rad
    $site -ab 1 -o x.hdr $room 2>err || fail "room: $(cat err)"
    grep -aq -- '--surroundings' x.hdr && fail "a room without surroundings"

    # without records nothing is read or written
    expect 0 'there are no ambient values to keep' 'no indirect light' \
        "$radsubmit" --local $view -ab 0 -x 9 -y 9 -af none.amb -o x.hdr $room
    [ ! -e none.amb ] || fail "a file without records"
}

# one that waits for no picture reads the file and leaves it
"$radcoord" --listen= --socket="$work/coord.sock" --state="$work/state" \
    2>coord.log &
until_true 20 "$radctl" --coordinator="$work/coord.sock" status ||
    fail "no coordinator"
# shellcheck disable=SC2086
expect 0 'nobody waits to add to it' detached \
    "$radsubmit" --coordinator="$work/coord.sock" --detach $view \
    -af room.amb $room
cmp room.amb first.amb || fail "detached: the file was changed"
finish
