#!/bin/sh
# completion.sh - bash completes the programs' options, their words, and all of
# radctl's and radscene's commands
set -u
: "${top_srcdir:=.}" "${top_builddir:=.}"
command -v bash >/dev/null || {
    echo "completion: no bash here"
    exit 77
}
top_srcdir=$(cd "$top_srcdir" && pwd) PATH=$(cd "$top_builddir" && pwd):$PATH
export top_srcdir PATH
exec bash -s <<'EOF'
failed=0
. "$top_srcdir/etc/radd.completion"
compopt() { :; } # is for readline

# expect "WORDS" PROGRAM WORD...: what the last word may become
expect()
{
    local want=$1
    shift
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _radd
    [ "${COMPREPLY[*]}" = "$want" ] || {
        echo "completion: $*: '${COMPREPLY[*]}', expected '$want'"
        failed=1
    }
}

# all commands, and in the order of --help
commands=$(radctl --help | sed -n 's/^  \([a-z][a-z]*\) .*/\1/p' | xargs)
expect "$commands" radctl ""
commands=$(radscene --help | sed -n 's/^  \([a-z][a-z]*\)  .*/\1/p' | xargs)
expect "$commands" radscene ""
expect "key" radctl ke
expect "add retire list" radctl key ""
expect "--partition=" radsubmit --part
expect "auto static scanbar window" radsubmit --partition =
expect "medium" radsubmit --quality = m
expect "8 16" radsubmit --bits =
expect "photographic linear human" radsubmit --tone =
expect "" radsubmit --stats =
expect "auto required" radd --sandbox =
expect "--keep-days=" radcoord --keep-d
exit $failed
EOF
