#!/bin/sh
# ambcache.sh - 10^5 ambient records from eight threads that look them up;
# RADD_SOAK=long: 10^6
each=12500
[ "${RADD_SOAK:-}" != long ] || each=125000
RADD_EACH=$each CK_RUN_CASE=threads_find_what_they_insert CK_FORK=no \
    "$top_builddir/tests/src/light/check_ambcache"
