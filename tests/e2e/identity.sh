#!/bin/sh
# identity.sh - however lines are shared, the picture and the primary rays are
# those of one thread that has the whole picture
#
# What is tried is drawn from a seed, which is printed; IDENTITY_SEED=n tries the
# same again, IDENTITY_RUNS=n as many.
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
. "$top_srcdir/tests/e2e/chance.sh"

runs=${IDENTITY_RUNS:-20}
draw_from "${IDENTITY_SEED:-}"

# count NAME: of seqpict, in all stages
count()
{
    awk -v name="$1" '$1 == name { n += $2 } END { print n + 0 }' counts
}

# many small lights, which -dv paints
cat >beads.rad <<'END'
void plastic wall 0 0 5 .5 .4 .3 0 0
wall ring ground 0 0 8 0 0 -1 0 0 1 0 9
void dielectric glass 0 0 5 .9 .9 .9 1.5 0
glass sphere ball 0 0 4 0 0 0 1
void light lamp 0 0 3 900 800 700
END
i=0
while [ $i -lt 12 ]; do
    any 600
    x=$((any - 300))
    any 300
    echo "lamp sphere bead$i 0 0 4 ${x}e-2 $((any - 150))e-2 ${i}e-1 .004"
    i=$((i + 1))
done >>beads.rad

all=0
spare=0
painted=0
run=0
while [ "$run" -lt "$runs" ]; do
    run=$((run + 1))
    one_of room reading beads
    scene=$word
    [ "$run" = 1 ] && scene=beads
    [ "$run" = 3 ] && scene=room
    one_of "-ps 4 -pt .05" "-ps 4 -pt .05" "-ps 8" "-ps 3 -pt .02" "-ps 1"
    sampling=$word
    one_of "-pj 0 -dj 0" "-pj .67 -dj .5" "-pj .67 -dj .5 --samples=3"
    jitter=$word
    any 60
    size="-x $((90 + any)) -y $((90 + any))"
    one_of 1 1 2 3
    if [ "$word" != 1 ]; then # as many samples
        size="--oversample=$word -x $(((90 + any) / word)) -y $(((91 + any) / word))"
        one_of "" "" --clamp=4
        size="$size $word"
    fi
    one_of "" "" -ab=1 -ab=2
    bounces="-ab 0"
    if [ -n "$word" ]; then
        any 2
        bounces="-ab ${word#*=} -aa .$((any + 2)) -ar 16 -ad 32 -as 8"
        bounces="$bounces --ambient=passes"
        if [ "$scene" = room ]; then
            one_of "" --error=20
            bounces="$bounces $word"
        fi
    fi
    if [ "$run" = 2 ]; then # so wide that passes come in parts
        size="-x 2100 -y 30 -pa 0"
        bounces="-ab 3 -aa .4 -ar 16 -ad 32 -as 8 --ambient=passes"
    fi
    if [ "$run" = 3 ]; then # more records in a tile than a message holds
        size="-x 60 -y 60"
        bounces="-ab 2 -aa .1 -ar 1024 -ad 16 -as 0 --ambient=passes"
    fi
    one_of scanbar static auto
    share="--partition=$word"
    if [ "$word" = static ]; then
        one_of uniform 5a 5b 20a 20b
        share="$share --estimate=$word"
        any 3
        [ "$any" = 0 ] && share="$share --no-balance"
    fi
    one_of "2 1" "3 1" "5 1" "8 1" "2 3" "1 3"
    share="$share --workers=${word% *} --threads=${word#* }"
    any 4
    depth= && [ "$any" = 0 ] && depth=yes
    case $scene in
    room) folder=$scenes file=room.rad where="-vf room.vf" ;;
    reading)
        folder=$top_srcdir/examples/reading-room file=room.rad
        where="-vf room.vf"
        ;;
    *)
        folder=$work file=beads.rad
        where="-vp 0 -9 3 -vd 0 9 -3 -vu 0 0 1 -vh 50 -vv 40"
        ;;
    esac
    options="$where $size $bounces $sampling $jitter"
    say="run $run: $options $share${depth:+ -z} $folder/$file"

    # shellcheck disable=SC2086 # options are words
    (cd "$folder" && "$top_builddir/tests/tools/seqpict" $options \
        ${depth:+-z "$work/ref.z"} --counts -o "$work/ref.hdr" $file) \
        2>counts || fail "$say: $(cat counts)"
    # shellcheck disable=SC2086
    (cd "$folder" && timeout -k 5 600 "$radsubmit" --local $options $share \
        ${depth:+-z "$work/out.z"} --stats="$work/stats.json" \
        -o "$work/out.hdr" $file) 2>stderr ||
        fail "$say: $(cat stderr)"
    body ref.hdr >ref.body
    body out.hdr >out.body
    cmp -s ref.body out.body || fail "$say: another picture"
    [ -z "$depth" ] || cmp -s ref.z out.z || fail "$say: other distances"
    primary=$(count primary_rays)
    [ "$(total stats.json primary_rays)" = "$primary" ] ||
        fail "$say: $(total stats.json primary_rays) primary rays, not $primary"
    # what was traced for nothing is in both
    kinds="shadow_rays ambient_rays ambient_values intersection_tests"
    [ "$(total stats.json paint_rays)" != "$(count paint_rays)" ] ||
        kinds="$kinds rays"
    for kind in $kinds; do
        alone=$(count $kind)
        [ "$(total stats.json estimate_rays)" != 0 ] ||
            [ "$(total stats.json speculative_rays)" != 0 ] ||
            [ "$(total stats.json $kind)" = "$alone" ] ||
            fail "$say: $(total stats.json $kind) $kind, not $alone"
    done
    nothing=$(total stats.json speculative_rays)
    [ "$((nothing * 100))" -le "$primary" ] ||
        fail "$say: $nothing rays for nothing, of $primary"
    all=$((all + primary))
    spare=$((spare + nothing))
    painted=$((painted + $(total stats.json paint_rays)))
done
echo "$all primary rays, $spare for nothing"
[ "$painted" -gt 0 ] || fail "nothing was painted"
check_nothing_left "after all of them"
finish
