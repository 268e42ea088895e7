#!/usr/bin/env bash
# rpict.sh [--seconds=S] [--rounds=N] [--only=REGEX] BUILD <ROWS - a table of
# how many times as long as one thread of radsubmit rpict takes.
#
# Each line of ROWS is a view of a scene:
#     FOLDER SCENE VIEW AIM SIDE SIDE4 SIDED [rendering options]
# with SCENE one file or several (a.rad+b.rad) in FOLDER, AIM how many times it
# should be, and how many pixels at most its pictures are wide and high: every
# pixel traced, one of four by four, every pixel with the lamps divided; - for
# none.  Empty lines and those that begin with # are skipped.  Each picture is
# rendered N times (3) by both, by turns (versus.sh); --seconds looks for sizes
# at which rpict takes S seconds first.  A cell is the median of the ratios, and
# in brackets rpict's seconds; one short of its aim is bold.  Progress, and what
# each run took, goes to stderr.  Needs rpict and oconv on PATH.
#
# All scenes of the comparison in doc/measured.md, in the folder that holds
# theirs, half an hour:
#     rpict.sh --seconds=5 BUILD <bench/scenes.rows
set -eu
usage()
{
    sed -n '2,19s/^# \{0,1\}//p' "$0" >&2
    exit 64
}

seconds='' rounds=3 only=.
while [ $# -gt 0 ]; do
    case $1 in
    --seconds=*) seconds=${1#*=} ;;
    --rounds=*) rounds=${1#*=} ;;
    --only=*) only=${1#*=} ;;
    -*) usage ;;
    *) break ;;
    esac
    shift
done
[ $# -eq 1 ] || usage
build=$(cd "$1" && pwd)
versus=$(cd "$(dirname "$0")" && pwd)/versus.sh
if ! { command -v rpict && command -v oconv; } >/dev/null; then
    echo "rpict.sh: rpict or oconv is not on PATH" >&2
    exit 69
fi
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
steady='-ab 0 -pj 0 -dj 0 -dt 0 -dc 1 -ss 0 -st .1 -u-'
kinds=('-ps 1 -ds 0' '-ps 4 -pt .05 -ds 0' '-ps 1 -ds .2')

# User seconds of rpict for a picture of that side.
trial() # SIDE OPTION...
{
    local TIMEFORMAT=%U side=$1
    shift
    if ! { time rpict -t 1 -vf "$view" -x "$side" -y "$side" "$@" \
        "$tmp/trial.oct" >/dev/null 2>"$tmp/err" </dev/null; } 2>"$tmp/took"; then
        cat "$tmp/err" >&2
        exit 1
    fi
    cat "$tmp/took"
}

# The side at which rpict takes about $seconds, from trials at half of SIDE and
# on.  What it takes goes with the square of the side, where few pixels of many
# are traced with less: a trial a fifth as long is near enough.
find_side() # SIDE OPTION...
{
    local side=$(($1 / 2)) took near=
    shift
    oconv -f "${files[@]}" >"$tmp/trial.oct"
    until [ -n "$near" ]; do
        took=$(trial "$side" "$@") || exit 1
        read -r side near <<<"$(awk -v x="$side" -v t="$took" -v s="$seconds" '
            BEGIN {
                r = s / (t > .01 ? t : .01)
                printf "%d %s", int(x * sqrt(r) / 2 + .5) * 2,
                    r < 5 || 20000 < x ? 1 : ""
            }')"
    done
    echo "$side"
}

# The median of the ratios and of rpict's seconds, from versus.sh's lines.
cell() # AIM
{
    awk -v aim="$1" '
        function median(v, n,    i, j, t) {
            for (i = 2; i <= n; i++)
                for (j = i; j > 1 && v[j] < v[j - 1]; j--) {
                    t = v[j]; v[j] = v[j - 1]; v[j - 1] = t
                }
            return n % 2 ? v[(n + 1) / 2] : (v[n / 2] + v[n / 2 + 1]) / 2
        }
        NF == 3 && $1 == "rpict" { theirs[++n] = $2 }
        NF == 3 && $1 == "radsubmit" { ratio[n] = $2 > 0 ? theirs[n] / $2 : 0 }
        END {
            if (!n) { print "failed"; exit }
            m = median(ratio, n)
            printf(m < aim ? "**%.2f** (%.1f)" : "%.2f (%.1f)", m,
                median(theirs, n))
        }'
}

echo "| scene, view | aim | \`${kinds[0]}\` | \`${kinds[1]}\` | \`${kinds[2]}\` |"
echo '| --- | --- | --- | --- | --- |'
while read -r folder scene view aim side1 side4 sided options; do
    case $folder in '' | '#'*) continue ;; esac
    name="$folder, ${scene//.rad/}, ${view%.vf}"
    IFS=+ read -ra files <<<"$scene"
    [[ $name =~ $only ]] || continue
    line="| $name | $aim |"
    sides=("$side1" "$side4" "$sided")
    for k in 0 1 2; do
        side=${sides[k]}
        if [ "$side" = - ]; then
            line+='  |'
            continue
        fi
        # the options are words
        # shellcheck disable=SC2206
        all=($steady ${kinds[k]} $options)
        cd "$folder"
        [ -z "$seconds" ] || side=$(find_side "$side" "${all[@]}") || exit 1
        ROUNDS=$rounds "$versus" "$build" "${files[*]}" "$view" -x "$side" \
            -y "$side" "${all[@]}" </dev/null >"$tmp/runs" || true
        cd - >/dev/null
        found=$(cell "$aim" <"$tmp/runs")
        echo "$name, $side, ${kinds[k]}: $found:" \
            "$(awk 'NF == 3 { printf " %s", $2 }' "$tmp/runs")" >&2
        line+=" $found |"
    done
    echo "$line"
done
