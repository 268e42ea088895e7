#!/bin/sh
# ambcache.sh - 10^6 ambient records from eight threads that look them up
RADD_SOAK=long CK_RUN_CASE=threads_find_what_they_insert CK_FORK=no \
    "$top_builddir/tests/src/light/check_ambcache"
