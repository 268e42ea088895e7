#!/usr/bin/env bash
# versus.sh BUILD SCENE VIEW [rendering options] - user seconds of one thread
# of radsubmit, and of rpict in the same run when it and oconv are on PATH.
#
# ROUNDS (3) interleaved runs of each; prints every run and the medians.  The
# seconds are those of all processes that a run starts: for rpict the octree is
# made beforehand, for radsubmit its making and sending counts.  SCENE is one
# file, or several in one word, blanks between them.
set -eu
[ $# -ge 3 ] || { sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 64; }
build=$(cd "$1" && pwd) view=$3
read -ra scene <<<"$2"
shift 3
rounds=${ROUNDS:-3}
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
TIMEFORMAT=%U

user_seconds() # NAME COMMAND...
{
    local name=$1
    shift
    { time "$@" >"$tmp/out" 2>"$tmp/err"; } 2>>"$tmp/$name"
    printf '%-10s %8s s\n' "$name" "$(tail -n 1 "$tmp/$name")"
}

median()
{
    sort -n "$tmp/$1" | awk '{ v[NR] = $1 }
        END { print NR % 2 ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2 }'
}

rpict=
if command -v rpict >/dev/null && command -v oconv >/dev/null; then
    rpict=yes
    oconv -f "${scene[@]}" >"$tmp/scene.oct"
fi
for ((i = 0; i < rounds; i++)); do
    [ -z "$rpict" ] ||
        user_seconds rpict rpict -t 1 -vf "$view" "$@" "$tmp/scene.oct"
    user_seconds radsubmit "$build/radsubmit" --local --workers=1 --threads=1 \
        --stats="$tmp/stats.json" -vf "$view" "$@" -o "$tmp/out.hdr" "${scene[@]}"
done
ours=$(median radsubmit)
awk -v s="$ours" '/"rays":/ && !n++ { gsub(/[^0-9]/, "");
    printf "radsubmit  %8.2f s median, %.2f million rays a second\n", s,
        $0 / s / 1e6 }' "$tmp/stats.json"
[ -z "$rpict" ] || awk -v a="$ours" -v b="$(median rpict)" 'BEGIN {
    printf "rpict      %8.2f s median; radsubmit takes %.2f of that\n", b, a / b }'
