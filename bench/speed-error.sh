#!/usr/bin/env bash
# speed-error.sh [options] BUILD - speed against error of indirect light
#
# A ladder of settings on each scene.  A picture is rendered large, averaged
# down to its scene's converged reference and compared with it, clipped at four
# times the mean (raderr -c 4), by pixel and by blocks of 4x4 pixels.  rpict
# and oconv, where they are on PATH, go over the ladder in the same run: each
# setting once with rpict, once with radsubmit on one thread and once on all
# processors, then again.  Seconds are those of all processes that a run
# starts; rpict's octree is made beforehand, radsubmit's within its time.
#
#   --scenes=LIST    of cornell, night, day, virtual, mirror, room (all that are
#                    there)
#   --folder=DIR     where the folders cornell, office, virtual and mirror are,
#                    with their references ($RADD_SCENES); room is the example
#   --size=N         width of the pictures, a multiple of the references' (960)
#   --runs=N         of each setting, with another seed each (3); all scenes
#                    once, then all once more
#   --minutes=N      begin no further picture when so many are over, and show
#                    what there is
#   --rungs=LIST     the ladder, settings of -aa/-ar/-ad/-as
#   --rpict-rungs=LIST   rpict's, in place of the first four of those; none: no
#                    rpict
#   --threads=LIST   of radsubmit: 1, or all, or a number (1,all)
#   --options=TEXT   rendering options besides, in place of the usual ones
#   --more=TEXT      rendering options that are added to them
#   --passes=N       of which room's reference is made, each two to five
#                    minutes of processor time; kept for the next run (12)
#   --results=DIR    what is written and kept (bench/results)
#   --table          only make table and plots again, from what is there
#
# A short form: --scenes=cornell,night --size=384 --runs=1
#   --rungs=.5/16/64/16,.3/32/128/32 --threads=1
set -eu
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=bench/lib.sh
. "$here/lib.sh"
folder=${RADD_SCENES:-} scenes=cornell,night,day,virtual,mirror,room
size=960 runs=3 minutes=100000
rungs=.5/16/64/16,.3/32/128/32,.25/48/192/48,.3/32/512/128
rungs=$rungs,.2/64/512/128,.15/96/1024/256
rpict_rungs='' threads=1,all passes=12 results=bench/results table=
options='-pa 0 -ps 4 -pt .05 -pj .9 -dj .5 -ds .2 -dt .05 -dc .75 -st .1
-ab 4 -lr 8 -lw 5e-4' more=''
# Of one pass of a reference: no cache, nothing cut short.
exact='-pa 0 -ps 1 -pj .95 -dj .9 -ds .2 -dt 0 -dc 1 -ss 1 -st 0 -ab 4 -aa 0
-as 0 -ad 16 -lr -8 -lw 1e-4'

while [ $# -gt 0 ]; do
    case $1 in
    --scenes=*) scenes=${1#*=} ;;
    --folder=*) folder=${1#*=} ;;
    --size=*) size=${1#*=} ;;
    --runs=*) runs=${1#*=} ;;
    --minutes=*) minutes=${1#*=} ;;
    --rungs=*) rungs=${1#*=} ;;
    --rpict-rungs=*) rpict_rungs=${1#*=} ;;
    --threads=*) threads=${1#*=} ;;
    --options=*) options=${1#*=} ;;
    --more=*) more=${1#*=} ;;
    --passes=*) passes=${1#*=} ;;
    --results=*) results=${1#*=} ;;
    --table) table=yes ;;
    --) shift && break ;;
    -*) die "unknown option '$1'" ;;
    *) break ;;
    esac
    shift
done
[ $# -eq 1 ] || usage
for n in "$size" "$runs" "$passes" "$minutes"; do
    [[ $n =~ ^[1-9][0-9]{0,5}$ ]] || die "'$n' is no number from 1"
done
is_ladder()
{
    local number='[0-9.]+' # of -aa; the others are whole
    [[ $1 =~ ^$number(/[0-9]+){3}(,$number(/[0-9]+){3})*$ ]] ||
        die "'$1' is no ladder: expected AA/AR/AD/AS,..."
}
is_ladder "$rungs"
case $rpict_rungs in
'') rpict_rungs=$(echo "$rungs" | cut -d, -f1-4) ;;
none) rpict_rungs='' ;;
*) is_ladder "$rpict_rungs" ;;
esac
for s in ${scenes//,/ }; do
    case $s in
    cornell | night | day | virtual | mirror | room) ;;
    *) die "no scene '$s'" ;;
    esac
done
for t in ${threads//,/ }; do
    [[ $t =~ ^(all|[1-9][0-9]{0,2})$ ]] || die "'$t' is no number of threads"
done
begin "$1" radcoord radd radsubmit raderr
if [ -n "$rpict_rungs" ] &&
    ! { command -v rpict && command -v oconv; } >/dev/null; then
    echo "rpict and oconv are not on PATH: radsubmit alone" >&2
    rpict_rungs=
fi

TIMEFORMAT='%U %R'

say() # what is under way, to a terminal
{
    [ ! -t 2 ] || printf '\r%-70s\r' "$1" >&2
}

# --- scenes ---

find_with_reference() # SCENE
{
    find_scene "$1"
    # shellcheck disable=SC2086 # options are words
    [ "$1" != room ] ||
        reference=$results/room-$(cat "$at"/* - <<<"$exact $passes" |
            cksum | cut -d' ' -f1)_conv.hdr
}

# The reference of the example: 192 pixels wide, 25 samples a pixel in each
# pass; its halves tell of its noise.
make_reference()
{
    local k half
    for ((k = 1; k <= passes; k++)); do
        say "room's reference: pass $k of $passes"
        # shellcheck disable=SC2086
        (cd "$at" && "$build/radsubmit" --local --seed=$((1000 + k)) \
            -vf $view -x 960 -y 730 $exact -o "$tmp/pass.hdr" $file) \
            2>"$tmp/err" </dev/null || die "$(tail -n 1 "$tmp/err")"
        "$build/raderr" --mean="$tmp/$((k % 2))-$k.hdr" -d 5 "$tmp/pass.hdr"
    done
    for half in 1 0; do
        [ ! -e "$tmp/$half-$((2 - half)).hdr" ] ||
            "$build/raderr" --mean="${reference%.hdr}_$half.hdr" \
                "$tmp/$half"-*.hdr
    done
    [ "$passes" -eq 1 ] || mv "${reference%.hdr}_0.hdr" \
        "${reference%.hdr}_b.hdr"
    mv "${reference%.hdr}_1.hdr" "${reference%.hdr}_a.hdr"
    "$build/raderr" --mean="$reference" "$tmp"/[01]-*.hdr
    rm -f "$tmp"/[01]-*.hdr "$tmp/pass.hdr"
}

compare() # OPTIONS... PICTURE PICTURE: mean_ratio and log_rmse
{
    "$build/raderr" -1 -c 4 "$@" | awk '{ print $2, $6 }'
}

# Half of what separates the reference's halves, by pixel and by block.
reference_noise()
{
    local a=${reference%.hdr}_a.hdr b=${reference%.hdr}_b.hdr
    if [ -e "$a" ] && [ -e "$b" ]; then
        echo "$(compare "$a" "$b") $(compare -b 4 "$a" "$b")" |
            awk '{ print $2 / 2, $4 / 2 }'
    else
        echo - -
    fi
}

# --- runs ---

# One line a run: scene, program, threads (0: rpict), rung, run, user and wall
# seconds, rays, ambient records, mean ratio, error by pixel, by block
judge() # PROGRAM THREADS RUNG RUN RAYS RECORDS
{
    local pixel block
    pixel=$(compare -d $((w / width)) "$tmp/out.hdr" "$reference")
    block=$(compare -d $((w / width)) -b 4 "$tmp/out.hdr" "$reference")
    echo "$scene $1 $2 $3 $4 $(tail -n 1 "$tmp/time") $5 $6 $pixel" \
        "${block#* }" >>"$data"
}

setting() # RUNG
{
    local part
    IFS=/ read -ra part <<<"$1"
    echo "-aa ${part[0]} -ar ${part[1]} -ad ${part[2]} -as ${part[3]}"
}

run_rpict() # RUNG RUN
{
    say "$scene, run $2 of $runs: rpict $1"
    # shellcheck disable=SC2046,SC2086
    (cd "$at" && { time rpict -t 100000 -vf $view -x $w -y $h $options \
        $extra $more $(setting "$1") "$tmp/$scene.oct" >"$tmp/out.hdr" \
        2>"$tmp/err"; } 2>"$tmp/time") ||
        die "rpict: $(tail -n 1 "$tmp/err")"
    judge rpict 0 "$1" "$2" \
        "$(awk '/ rays, 100/ { r = $2 } END { print r + 0 }' "$tmp/err")" -
}

run_radsubmit() # THREADS RUNG RUN
{
    say "$scene, run $3 of $runs: radsubmit $2, threads: $1"
    # shellcheck disable=SC2046,SC2086
    (cd "$at" && { time "$build/radsubmit" --local --workers=1 \
        --threads=$1 --seed=$3 --stats="$tmp/stats.json" -vf $view \
        -x $w -y $h $options $extra $more $(setting "$2") \
        -o "$tmp/out.hdr" $file 2>"$tmp/err" </dev/null; } 2>"$tmp/time") ||
        die "radsubmit: $(tail -n 1 "$tmp/err")"
    # shellcheck disable=SC2046 # words
    judge radd "$1" "$2" "$3" $(awk -v head= -f "$here/stats.awk" \
        "$tmp/stats.json" | awk '{ print $3, $6 }')
}

# A scene's octree and what is known of its reference; sets $w and $h.
prepare_scene()
{
    local factor
    size_of "$reference"
    [ $((size % width)) -eq 0 ] ||
        die "$scene: $size is not a multiple of the reference's $width"
    factor=$((size / width)) w=$size
    h=$((height * factor))
    [ "$1" -eq 1 ] || return 0
    echo "$scene reference $width $height $w $h $(reference_noise)" >>"$data"
    [ -z "$rpict_rungs" ] ||
        (cd "$at" && oconv -f "$file" >"$tmp/$scene.oct") ||
        die "$scene: no octree"
}

# Is there time for another picture?
in_time()
{
    [ $SECONDS -lt $((60 * minutes)) ]
}

measure_scene() # RUN
{
    local run=$1 rung t all
    all=$(getconf _NPROCESSORS_ONLN)
    prepare_scene "$run"
    for rung in $(echo "$rungs,$rpict_rungs" | tr , '\n' | awk '!n[$0]++'); do
        [[ ,$rpict_rungs, != *,$rung,* ]] || ! in_time ||
            run_rpict "$rung" "$run"
        [[ ,$rungs, == *,$rung,* ]] || continue
        for t in ${threads//,/ }; do
            ! in_time || run_radsubmit "${t/all/$all}" "$rung" "$run"
        done
    done
}

# The scenes whose reference is there, or can be made, in $present.
find_references()
{
    present=
    for scene in ${scenes//,/ }; do
        find_with_reference "$scene"
        if [ "$scene" != room ] && [ ! -r "$reference" ]; then
            echo "# $scene left out: no $(basename "$reference") (--folder)" \
                >>"$data"
            continue
        fi
        [ -r "$reference" ] || make_reference
        present="$present $scene"
    done
}

data=$results/speed-error.runs
if [ -z "$table" ]; then
    {
        echo "# $(date -u +%Y-%m-%d) $("$build/radsubmit" --version)," \
            "$(getconf _NPROCESSORS_ONLN) processors," \
            "$(sed -n 's/^model name.*: //p' /proc/cpuinfo 2>/dev/null |
                head -n 1)"
        # shellcheck disable=SC2086
        echo "# options:" $options $more
    } >"$data"
    find_references
    for ((n = 1; n <= runs; n++)); do
        for scene in $present; do
            find_with_reference "$scene"
            measure_scene $n
        done
    done
    say ''
fi
grep -q ' reference ' "$data" || die "nothing measured"

# --- table and plots ---

awk -v plots="$tmp" -f "$here/speed-error.awk" "$data" |
    tee "$results/speed-error.txt"
if ! command -v gnuplot >/dev/null; then
    echo "gnuplot is not on PATH: no plots" >&2
    exit 0
fi
for x in seconds rays; do
    for type in png svg; do
        gnuplot -e "dir='$tmp'; x='$x'; type='$type'" \
            -e "out='$results/speed-error-$x.$type'" \
            "$here/speed-error.gnuplot"
    done
done
echo "plots: $results/speed-error-{seconds,rays}.{png,svg}"
