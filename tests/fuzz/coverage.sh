#!/bin/sh
# coverage.sh [PERCENT] - how many lines of the decoders the corpora, their unit
# tests and some tests of programs execute; together PERCENT of them (90) at least
#
# `make coverage` calls it in a build that counts:
#   ../configure CC=gcc CFLAGS='-O0 -g --coverage' && make coverage
# What is left in files below that are mostly answers to a lack of memory.
# Exit status: 0 it is so, 1 it is less, 2 the build does not count, or a test
# fails.
set -u
: "${top_srcdir:=.}" "${top_builddir:=.}"
percent=${1:-90}
top_srcdir=$(cd "$top_srcdir" && pwd)
top_builddir=$(cd "$top_builddir" && pwd)
export top_srcdir top_builddir

# What reads bytes or texts of others: files of scenes and pictures, messages,
# keys, settings, what is kept on disk.
decoders='
src/scene/file/lex src/scene/file/parse src/scene/file/data src/scene/file/font
src/scene/file/bundle src/scene/file/specpict src/scene/calc/calcparse
src/scene/bsdf/bsdfxml src/scene/bsdf/bsdfmatrix src/scene/bsdf/bsdftree
src/scene/bsdf/bsdftreeread src/scene/meshfile src/scene/octfile src/scene/octin
src/image/hdr src/image/hdrread src/points/points src/base/params
src/picture/view src/picture/facts
proto/wire proto/codec proto/message proto/msg_job proto/msg_order
proto/msg_passes proto/msg_peer proto/msg_session proto/msg_sharing
proto/msg_store proto/msg_work proto/frame proto/ambshare
net/key/keyfile net/tls net/address net/inifile
daemon/ground/conf daemon/radd/hours daemon/journal/journal
daemon/journal/journal_put daemon/journal/journal_read
client/job/costs client/records/ambfile client/points/pointfile'

cd "$top_builddir" || exit 2
find src proto net daemon client tests -name '*.gcda' -exec rm -f {} +
{
    for target in "$top_srcdir"/tests/fuzz/fuzz_*.c; do
        name=$(basename "$target" .c)
        echo "tests/fuzz/$name $top_srcdir/tests/fuzz/corpus/${name#fuzz_}"
    done
    for name in ambfile ambshare bsdf bundle calc client conf conn \
        costs data facts font frame framing func gate hdr idle keyfile \
        message octfile octree params parse place points spec spectrum \
        store table tls view wire; do
        find tests -mindepth 2 -type f -name "check_$name"
    done
    echo "./radd --help"
    echo "./radcoord --version"
    for name in keys radctl_check radd_refused radscene; do
        echo "sh $top_srcdir/tests/e2e/$name.sh"
    done
} >coverage.runs
while read -r run; do
    # shellcheck disable=SC2086 # a program and its argument
    CK_FORK=no $run >coverage.log 2>&1 </dev/null || {
        cat coverage.log
        echo "$run: failed" >&2
        exit 2
    }
done <coverage.runs

for decoder in $decoders; do
    folder=$(dirname "$decoder") name=$(basename "$decoder")
    found=
    # a library's objects have its name before theirs
    for notes in "$folder/$name.gcno" "$folder"/lib*_a-"$name.gcno"; do
        [ -e "$notes" ] || continue
        found=$(gcov -n "$notes" 2>/dev/null |
            sed -n "/^File '.*$name\\.c'/{n;s/^Lines executed:\\([0-9.]*\\)% of \\([0-9]*\\)/\\1 \\2/p;}")
        break
    done
    echo "$decoder.c ${found:-none 0}"
done | awk -v percent="$percent" '
$2 == "none" { print $1 ": not counted"; missing = 1; next }
{
    printf("%-32s %5d lines %6.1f %%%s\n", $1, $3, $2,
        ($2 + 0 < percent ? "  less" : ""))
    all += $3
    done += $3 * $2 / 100
}
END {
    if (all > 0)
        printf("%-32s %5d lines %6.1f %%\n", "all", all, 100 * done / all)
    exit missing ? 2 : 100 * done < percent * all
}'
