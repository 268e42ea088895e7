#!/bin/sh
# pairs.sh - each program with each pair of its options (pairs.py says how):
# nothing crashes, hangs or calls itself defective, what is refused is named, and
# two workers write the bytes that one writes
#
# RADD_SOAK=long tries all pairs of the clients' options instead of RADD_PAIRS
# (60 of each program) that RADD_SEED draws.
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
command -v python3 >/dev/null || {
    echo "pairs: no python3 here"
    exit 77
}
for what in daemons clients; do
    mkdir "$work/$what"
    python3 "$top_srcdir/tests/soak/pairs.py" "$top_builddir" "$scenes" \
        "$work/$what" $what || fail "$what"
done
check_nothing_left "all pairs"
finish
