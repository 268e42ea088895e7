#!/usr/bin/env bash
# eta.sh [options] BUILD - what is said of a job beforehand, against what comes
#
# Jobs of all kinds, each once with --dry-run and once rendered on a cluster of
# its own.  Of each: processor time and rays that --dry-run said, divided by
# those that came; the time left that --progress said first, and at 5 %, 20 %
# and 50 % of the time, divided by the time that was left then; and the
# relative error that the last line promised, beside that of the picture
# averaged down to its scene's converged reference (raderr -c 4).  All are
# ratios of one run, so that other work on the machine weighs little.
#
#   --folder=DIR    where the folders cornell, office, virtual and mirror are,
#                   with their references ($RADD_SCENES); without, the example
#                   alone
#   --jobs=LIST     numbers of the jobs, from 1 (all)
#   --results=DIR   where the table is written (bench/results)
set -eu
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=bench/lib.sh
. "$here/lib.sh"
folder=${RADD_SCENES:-} results=bench/results jobs=''

while [ $# -gt 0 ]; do
    case $1 in
    --folder=*) folder=${1#*=} ;;
    --results=*) results=${1#*=} ;;
    --jobs=*) jobs=${1#*=} ;;
    --) shift && break ;;
    -*) die "unknown option '$1'" ;;
    *) break ;;
    esac
    shift
done
[ $# -eq 1 ] || usage
[[ $jobs =~ ^([0-9]+(,[0-9]+)*)?$ ]] || die "'$jobs' is no list of jobs"
begin "$1" radcoord radd radsubmit raderr

# Scene, workers, pixels of a side of the reference's that one is averaged from
# (0: there is none to compare with, and the width follows), options.
list()
{
    cat <<'JOBS'
cornell 1 5 --quality=high -ab 4
cornell 2 0 1600 -ab 0 -ps 1 -pj 1 -ds .02 -dj 1 -dt 0 -dc 1
night 1 10 --quality=medium
night 2 5 --quality=high -ab 4
night 2 5 -ab 1 -aa .15 -ar 64 -ad 512 -as 128 -ps 1 -dj .7 -ds .1
day 1 5 --quality=high -ab 4
virtual 2 15 --quality=high -ab 4 -dr 2
mirror 1 5 --quality=high -ab 3
room 1 0 1400 --quality=medium --oversample=2
room 2 0 240 --quality=high --oversample=2
room 2 0 400 --quality=high --oversample=1 -S 1 --views=VIEWS
JOBS
}

number() # NAME FILE: the first of that name
{
    sed -n "s/^ *\"$1\": \([0-9.eE+-]*\),\{0,1\}\$/\1/p" "$2" | head -n 1
}

# Each line that radsubmit says, behind the time.
stamp()
{
    local line
    while read -r line; do
        echo "$EPOCHREALTIME $line"
    done
}

# The time left that was said, by the time that was left: the first one with
# when it was said, then at some shares of the time.
read_lines() # BEGIN FILE
{
    awk -v begin="$1" '
    / left / && match($0, /[0-9:]+ left/) {
        n++
        k = split(substr($0, RSTART, RLENGTH - 5), part, ":")
        said[n] = 0
        for (i = 1; i <= k; i++) said[n] = 60 * said[n] + part[i]
        at[n] = $1 - begin
    }
    / done in / { end = $1 - begin }
    function ratio(i) {
        return i && end > at[i] ? sprintf("%.2f", said[i] / (end - at[i])) : "-"
    }
    function told(t,    i, last) {
        for (i = 1; i <= n && at[i] <= t; i++) last = i
        return last
    }
    END {
        printf "%.1f %s %s %s %s %s\n", end, n ? sprintf("%.1f", at[1]) : "-",
            ratio(n ? 1 : 0), ratio(told(.05 * end)), ratio(told(.2 * end)),
            ratio(told(.5 * end))
    }' "$2"
}

render() # WORKERS SIZE OPTIONS...: sets $cpu and leaves files in $tmp
{
    local workers=$1 size=$2
    shift 2
    # shellcheck disable=SC2086 # options are words
    (cd "$at" && "$build/radsubmit" --dry-run --local --workers="$workers" \
        --stats="$tmp/dry.json" -vf "$view" $size "$@" "$file") \
        >"$tmp/dry" 2>"$tmp/err" || die "$(tail -n 1 "$tmp/err")"
    begin=$EPOCHREALTIME
    TIMEFORMAT=%U
    # shellcheck disable=SC2086
    { time (cd "$at" && "$build/radsubmit" --local --workers="$workers" \
        --progress=always --stats="$tmp/real.json" -vf "$view" $size "$@" \
        -o "$tmp/$out" "$file" 2> >(stamp >"$tmp/said")); } 2>"$tmp/cpu" ||
        die "$(tail -n 1 "$tmp/said")"
    for _ in 1 2 3 4 5; do
        grep -q ' done in ' "$tmp/said" && break
        sleep .2
    done
    cpu=$(tail -n 1 "$tmp/cpu")
}

# A walk of six steps into the room.
views()
{
    awk '{
        for (i = 1; i < NF; i++) if ($i == "-vp") at = i
        for (f = 0; f < 6; f++) {
            $(at + 1) += .05; $(at + 2) += .05
            print
        }
    }' "$1"
}

row() # NUMBER SCENE WORKERS BLOCK OPTIONS...
{
    local k=$1 scene=$2 workers=$3 block=$4 size error came said=-
    shift 4
    find_scene "$scene"
    out=$k.hdr
    if [ "$block" -gt 0 ]; then
        size_of "$reference"
        size="-pa 0 -x $((width * block)) -y $((height * block))"
    else
        size="-x $1 -y $1"
        shift
    fi
    case "$*" in
    *VIEWS*)
        views "$at/$view" >"$tmp/views"
        out=$k-%d.hdr
        set -- "${@/VIEWS/$tmp/views}"
        ;;
    esac
    render "$workers" "$size" "$@"
    error=$(sed -n 's/.*relative error about \([^ ]*\) %.*/\1/p' "$tmp/said")
    came=-
    if [ "$block" -gt 0 ]; then
        came=$("$build/raderr" -1 -c 4 -d "$block" "$tmp/$out" "$reference" |
            awk '{ printf "%.1f", 100 * $6 }')
    fi
    said=$(number estimate "$tmp/dry.json" |
        awk '{ printf "%.2g", 100 * $1 }')
    # shellcheck disable=SC2046 # words
    printf '| %s, %s, %s | %s |\n' "$scene" "$workers" "${*/$tmp\/views/6}" \
        "$(read_lines "$begin" "$tmp/said" | awk -v cpu="$cpu" \
            -v dry="$(number cpu_s "$tmp/dry.json")" \
            -v rays="$(number rays "$tmp/real.json")" \
            -v foreseen="$(number rays "$tmp/dry.json")" \
            -v error="$said | ${error:--} | $came" '{
            printf "%.1f | %s | %.2f | %.2f | %s | %s | %s | %s | %s | %s",
                cpu, $1, dry / cpu, foreseen / rays, $2, $3, $4, $5, $6, error
        }')"
}

{
    cat <<'HEAD'
| job: scene, workers, options | cpu [s] | wall [s] | --dry-run: cpu | rays | first said at [s] | first | 5 % | 20 % | 50 % | error: --dry-run [%] | at the end | measured |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
HEAD
    n=0
    while read -r line; do
        n=$((n + 1))
        case ",${jobs:-$n}," in
        *",$n,"*) ;;
        *) continue ;;
        esac
        # shellcheck disable=SC2086 # words
        set -- $line
        [ "$1" = room ] || [ -n "$folder" ] || continue
        row "$n" "$@" </dev/null
    done < <(list)
} | tee "$results/eta.txt"
