#!/usr/bin/env bash
# rpict.sh BUILD <ROWS - a table of how much faster than rpict one thread is.
#
# Each line of ROWS is a picture: FOLDER VIEW SIDE SCENE [rendering options].
# Each is rendered ROUNDS (3) times by both, by turns (versus.sh), SIDE pixels
# at most wide and high; empty lines and those that begin with # are skipped.
# Needs rpict and oconv on PATH.
set -eu
[ $# -eq 1 ] || { sed -n '2,7s/^# \{0,1\}//p' "$0" >&2; exit 64; }
build=$(cd "$1" && pwd)
versus=$(cd "$(dirname "$0")" && pwd)/versus.sh
if ! { command -v rpict && command -v oconv; } >/dev/null; then
    echo "rpict.sh: rpict or oconv is not on PATH" >&2
    exit 69
fi
echo '| folder, scene, view, side, options | rpict | radsubmit | times faster |'
echo '| --- | --- | --- | --- |'
while read -r folder view side scene options; do
    case $folder in '' | '#'*) continue ;; esac
    # shellcheck disable=SC2086 # the options are words
    (cd "$folder" && "$versus" "$build" "$scene" "$view" -x "$side" \
        -y "$side" $options </dev/null) |
        awk -v row="$folder, $scene, $view, $side, \`$options\`" '
            $5 == "median," || $5 == "median;" || $4 == "median," ||
            $4 == "median;" { s[$1] = $2 }
            END { printf "| %s | %.2f s | %.2f s | %.2f |\n", row, s["rpict"],
                s["radsubmit"], s["rpict"] / s["radsubmit"] }'
done
