# radd.m4 - the project's own configure macros

# Flags of every compilation, in RADD_CFLAGS (CFLAGS is the user's).
# -ffp-contract=off and no fast math: the same bits on every machine whose
# numeric fingerprint agrees.
# No pairing of scalars: points are three doubles, stored one by one; a load of
# two of them at once waits until the stores have reached the cache.
AC_DEFUN([RADD_COMPILER_FLAGS], [
RADD_CFLAGS="-std=gnu11 -ffp-contract=off -fno-math-errno \
-fno-tree-slp-vectorize -Wall -Wextra -Wshadow \
-Wstrict-prototypes -Wmissing-prototypes -Wpointer-arith -Wwrite-strings -Wvla"
AS_IF([test "x$enable_werror" = xyes], [RADD_CFLAGS="$RADD_CFLAGS -Werror"])
RADD_LDFLAGS=
AC_SUBST([RADD_CFLAGS])
AC_SUBST([RADD_LDFLAGS])
])

AC_DEFUN([RADD_SANITIZERS], [
AS_CASE([$enable_sanitizers],
    [''|no], [],
    [yes], [radd_san=address,undefined],
    [radd_san=$enable_sanitizers])
AS_IF([test "x$radd_san" != x], [
    radd_cflags=$CFLAGS
    CFLAGS="$CFLAGS -fsanitize=$radd_san"
    AC_LINK_IFELSE([AC_LANG_PROGRAM], [],
        [AC_MSG_ERROR([$CC does not link with -fsanitize=$radd_san])])
    CFLAGS=$radd_cflags
    RADD_CFLAGS="$RADD_CFLAGS -fsanitize=$radd_san -fno-omit-frame-pointer \
-fno-sanitize-recover=all -g"
    RADD_LDFLAGS="$RADD_LDFLAGS -fsanitize=$radd_san"
])
AM_CONDITIONAL([SANITIZED], [test "x$radd_san" != x])
])

# With --enable-fuzzers the targets are libFuzzer programs; without, each is
# linked with a driver that replays its corpus, as part of the tests.
AC_DEFUN([RADD_FUZZERS], [
AS_IF([test "x$enable_fuzzers" = xyes], [
    AS_CASE([$($CC --version 2>/dev/null)], [*clang*], [],
        [AC_MSG_ERROR([--enable-fuzzers needs CC=clang])])
    RADD_CFLAGS="$RADD_CFLAGS -fsanitize=fuzzer-no-link"
    RADD_LDFLAGS="$RADD_LDFLAGS -fsanitize=fuzzer-no-link"
])
AC_SUBST([LIBFUZZER], [-fsanitize=fuzzer])
AM_CONDITIONAL([FUZZERS], [test "x$enable_fuzzers" = xyes])
])
