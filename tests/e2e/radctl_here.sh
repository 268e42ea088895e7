#!/bin/sh
# radctl_here.sh - on the coordinator's own machine radctl needs not be told
# where that is; and where it is not, it says what it tried
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

# What stands under /run on this machine is nobody's business here: a /run of
# our own, where that is allowed.
if [ "${RADD_TEST_RUN:-}" != own ]; then
    map=
    [ "$(id -u)" -eq 0 ] || map=-r
    if RADD_TEST_RUN=own unshare $map -m sh -c \
        'mount -t tmpfs none /run && : >"$0" && exec sh "$1"' \
        "$work/mounted" "$top_srcdir/tests/e2e/radctl_here.sh"; then
        rm -rf "$work"
        exit 0
    fi
    [ ! -e "$work/mounted" ] || exit 1
    rm -rf "$work"
    echo "skipped: this user may mount nothing, so /run is not ours"
    exit 77
fi

expect 69 "no coordinator is named by --coordinator, RADD_COORDINATOR or \
radsubmit.conf: no coordinator at '/run/radd/radcoord.sock'" "not there" \
    "$radctl" status
expect 69 "(--keys edits a key file)" "key" "$radctl" key list
expect 69 "no coordinator at '/run/other.sock': no such file" "named" \
    "$radctl" --coordinator=/run/other.sock status
grep -q "is named by" stderr && fail "named: $(cat stderr)"
"$radctl" --coordinator=no-such-host.invalid:7420 status >stdout 2>stderr
[ $? -eq 69 ] || fail "a host that there is not"
grep -Eq "'no-such-host.invalid:7420': (no such host|the host's name cannot)" \
    stderr || fail "a host that there is not: $(cat stderr)"

"$radcoord" --listen= --state="$work/state" --ports-file="$work/ports" \
    2>c.log &
coord_pid=$!
until_true 30 test -s ports || fail "radcoord does not start: $(cat c.log)"
"$radctl" status >stdout 2>stderr || fail "status: $(cat stderr)"
grep -q '^program  *radcoord' stdout || fail "status says $(cat stdout)"
kill -TERM "$coord_pid"
wait "$coord_pid" || fail "the coordinator ended with $?"
finish
