#!/bin/sh
# run.sh [SECONDS [TARGET...]] - each fuzz target, or those named (parse, hdr),
# for so long (60), one after the other, from its seeds.  Needs a build with
# --enable-fuzzers; `make fuzz` calls it.
# What crashes, hangs or leaks stays in the folder findings of the build.  What
# else the target came up with is dropped: the corpora of the repository hold
# seeds and former findings only.
# Exit status: 0 nothing was found, 1 something was, 2 no such target.
set -u
: "${top_srcdir:=.}" "${top_builddir:=.}"
seconds=${1:-60}
[ $# -gt 0 ] && shift
if [ $# -eq 0 ]; then
    for source in "$top_srcdir"/tests/fuzz/fuzz_*.c; do
        name=$(basename "$source" .c)
        set -- "$@" "${name#fuzz_}"
    done
fi
findings=$top_builddir/findings
tmp=$(mktemp -d) || exit 2
trap 'rm -rf "$tmp"' EXIT
trap 'exit 2' HUP INT TERM
mkdir -p "$findings" || exit 2
status=0
for name; do
    target=$top_builddir/tests/fuzz/fuzz_$name
    if ! "$target" -help=1 2>&1 | grep -q max_total_time; then
        echo "$target is no fuzz target: --enable-fuzzers?" >&2
        exit 2
    fi
    mkdir "$tmp/$name"
    if "$target" -max_total_time="$seconds" -timeout=10 -print_final_stats=1 \
        -artifact_prefix="$findings/$name-" "$tmp/$name" \
        "$top_srcdir/tests/fuzz/corpus/$name" >"$tmp/log" 2>&1 </dev/null; then
        printf '%-10s %10s runs in %s s, nothing found\n' "$name" \
            "$(sed -n 's/^stat::number_of_executed_units: //p' "$tmp/log")" \
            "$seconds"
    else
        status=1
        cp "$tmp/log" "$findings/$name.log"
        echo "$name: found something, see $findings/$name.log"
    fi
    rm -rf "${tmp:?}/$name"
done
exit $status
