#!/bin/sh
# Every fuzz target replays its corpus; a target without one fails.  Seeds that
# hold messages must be heard to their end, and get to where fuzz/reach says.
set -u
status=0
corpora=$top_srcdir/tests/fuzz/corpus
for source in "$top_srcdir"/tests/fuzz/fuzz_*.c; do
    name=$(basename "$source" .c)
    [ -e "$source" ] || { echo "no fuzz targets"; exit 77; }
    "$top_builddir/tests/fuzz/$name" "$corpora/${name#fuzz_}" || {
        echo "$name: failed on its corpus" >&2
        status=1
    }
done

said() {
    RADD_FUZZ_SAY=1 "$top_builddir/tests/fuzz/fuzz_${1%%/*}" "$corpora/$1"
}

for seed in "$corpora"/frame/* "$corpora"/journal/* "$corpora"/session/* \
    "$corpora"/worker/*; do
    seed=$(basename "$(dirname "$seed")")/$(basename "$seed")
    if said "$seed" | grep -E 'breaks the protocol|is refused'; then
        echo "seed $seed ends early" >&2
        status=1
    fi
    case $seed in
    frame/*) want="0 says $(basename "$seed" | tr '[:lower:]' '[:upper:]')" ;;
    *) want=$(sed -n "s|^$seed ||p" "$top_srcdir/tests/fuzz/reach") ;;
    esac
    [ -n "$want" ] || { echo "seed $seed: not in fuzz/reach" >&2; status=1; }
    echo "$want" | while read -r line; do
        said "$seed" | sed 's/ *$//' | grep -qxF "$line" || {
            echo "seed $seed does not get to: $line" >&2
            exit 1
        }
    done || status=1
done
exit $status
