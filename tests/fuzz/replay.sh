#!/bin/sh
# Every fuzz target replays its corpus; a target without one fails.
set -u
status=0
for source in "$top_srcdir"/tests/fuzz/fuzz_*.c; do
    name=$(basename "$source" .c)
    corpus=$top_srcdir/tests/fuzz/corpus/${name#fuzz_}
    [ -e "$source" ] || { echo "no fuzz targets"; exit 77; }
    "$top_builddir/tests/fuzz/$name" "$corpus" || {
        echo "$name: failed on its corpus" >&2
        status=1
    }
done
exit $status
