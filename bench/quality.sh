#!/usr/bin/env bash
# quality.sh [options] BUILD - what each --quality of radsubmit delivers
#
# Each scene is rendered by each word alone, one option --quality, and compared
# with a reference of eight bounces without a cache: by pixel, and by areas of
# 5 by 5 pixels, as radsubmit says its error.  Values are clipped at four times
# the mean (raderr -c 4), and the reference's own noise is taken off, by squares.
# Columns: processor seconds, error by pixel, error by area, the error that
# radsubmit said, and that --dry-run predicted [%].
#
#   --scenes=LIST    of cornell, night, day, virtual, mirror, room (all that are
#                    there)
#   --folder=DIR     where the folders cornell, office, virtual and mirror are
#                    ($RADD_SCENES); room is the example
#   --qualities=LIST draft,low,medium,high
#   --passes=N       of which a reference is made, of four samples a pixel; kept
#                    for the next run (30)
#   --size=N         columns of the pictures (240)
#   --runs=N         with another seed each; the mean is shown (1)
#   --results=DIR    what is written and kept (bench/results)
set -eu
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=bench/lib.sh
. "$here/lib.sh"
folder=${RADD_SCENES:-} scenes=cornell,night,day,virtual,mirror,room
qualities=draft,low,medium,high passes=30 size=240 runs=1
results=bench/results
# Of one pass of a reference: no cache, nothing cut short.
exact='-ps 1 -pj .95 -dj .9 -ds .2 -dt 0 -dc 1 -dr 3 -ss 1 -st 0 -ab 8 -aa 0
-as 0 -ad 4 -lr -12 -lw 1e-4'

while [ $# -gt 0 ]; do
    case $1 in
    --scenes=*) scenes=${1#*=} ;;
    --folder=*) folder=${1#*=} ;;
    --qualities=*) qualities=${1#*=} ;;
    --passes=*) passes=${1#*=} ;;
    --size=*) size=${1#*=} ;;
    --runs=*) runs=${1#*=} ;;
    --results=*) results=${1#*=} ;;
    -*) die "unknown option '$1'" ;;
    *) break ;;
    esac
    shift
done
[ $# -eq 1 ] || usage
for n in "$passes" "$size" "$runs"; do
    [[ $n =~ ^[1-9][0-9]{0,4}$ ]] || die "'$n' is no number from 1"
done
begin "$1" radsubmit raderr
TIMEFORMAT='%U'

render() # OPTIONS...: the picture $tmp/out.hdr, in $tmp/time its seconds
{
    (cd "$at" && { time "$build/radsubmit" --local --workers=1 -vf "$view" \
        "$@" "$file" 2>"$tmp/err" </dev/null; } 2>"$tmp/time") ||
        die "radsubmit: $(tail -n 1 "$tmp/err")"
}

# The mean of many passes, of halves of them too: what those differ by tells of
# the noise.
make_reference() # SCENE
{
    local k half
    # shellcheck disable=SC2086 # options are words
    for ((k = 1; k <= passes; k++)); do
        render --seed=$((1000 + k)) --oversample=2 -x "$size" -y "$size" \
            $exact -o "$tmp/$((k % 2))-$k.hdr"
    done
    for half in 0 1; do
        "$build/raderr" --mean="${reference%.hdr}_$half.hdr" "$tmp/$half"-*.hdr
    done
    "$build/raderr" --mean="$reference" "$tmp"/[01]-*.hdr
    rm -f "$tmp"/[01]-*.hdr
}

log_rmse() # OPTIONS... TEST REFERENCE
{
    "$build/raderr" -1 -c 4 "$@" | awk '{ print $6 }'
}

# Error in percent without the reference's noise, which is half of what its
# halves differ by.
error_of() # OPTIONS...
{
    local all noise
    all=$(log_rmse "$@" "$tmp/out.hdr" "$reference")
    noise=$(log_rmse "$@" "${reference%.hdr}_0.hdr" "${reference%.hdr}_1.hdr")
    awk -v a="$all" -v n="$noise" 'BEGIN {
        e = a * a - n * n / 4
        printf "%.2g", 100 * sqrt(e > 0 ? e : 0) }'
}

percent() # of standard input, the number before the last line's first % sign
{
    sed -n 's/^[^%]*[^0-9.]\([0-9.]\{1,\}\) %.*/\1/p' | tail -n 1
}

measure() # SCENE QUALITY RUN
{
    local said dry
    render --dry-run --seed="$3" --quality="$2" -x "$size" -y "$size" \
        >"$tmp/dry"
    dry=$(grep '^error ' "$tmp/dry" | percent)
    render --seed="$3" --quality="$2" -x "$size" -y "$size" -o "$tmp/out.hdr"
    said=$(percent <"$tmp/err")
    echo "$1 $2 $(tail -n 1 "$tmp/time") $(error_of) $(error_of -b 5)" \
        "${said:--} ${dry:--}" >>"$data"
}

data=$results/quality.runs
echo "# $(date -u +%Y-%m-%d) $("$build/radsubmit" --version), $size columns" \
    >"$data"
for scene in ${scenes//,/ }; do
    find_scene "$scene"
    if [ ! -r "$at/$file" ]; then
        echo "# $scene left out: it is not there (--folder)" >>"$data"
        continue
    fi
    reference=$results/quality-$scene-$size-$passes.hdr
    [ -r "$reference" ] || make_reference
    for quality in ${qualities//,/ }; do
        for ((run = 1; run <= runs; run++)); do
            measure "$scene" "$quality" "$run"
        done
    done
done

# A row a scene, a column a quality: seconds / by pixel / by area, said, dry.
awk -v words="${qualities//,/ }" '
/^#/ { print; next }
{
    if (!($1 in seen)) { seen[$1] = 1; order[++n] = $1 }
    k = $1 " " $2; runs[k]++
    for (i = 3; i <= 7; i++) sum[k, i] += $i
}
function mean(k, i) { return sprintf("%.2g", sum[k, i] / runs[k]) }
END {
    m = split(words, w, " ")
    row = "| scene"
    for (j = 1; j <= m; j++) row = row " | " w[j]
    print row " |"; print "| --- " substr("| --- | --- | --- | --- | --- ", 1, 6 * m) "|"
    for (i = 1; i <= n; i++) {
        row = "| " order[i]
        for (j = 1; j <= m; j++) {
            k = order[i] " " w[j]
            row = row " | " mean(k, 3) " s: " mean(k, 4) ", " mean(k, 5) \
                "; " mean(k, 6) ", " mean(k, 7)
        }
        print row " |"
    }
}' "$data" | tee "$results/quality.md"
