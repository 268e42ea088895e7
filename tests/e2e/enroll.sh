#!/bin/sh
# enroll.sh - radctl enroll: a folder with settings and key for each host, with
# which a worker joins; the same again changes no key
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
umask 022

hosts=$(seq -f ws%02g 1 20)
# shellcheck disable=SC2086
"$radctl" enroll $hosts --keys=keys --coordinator=render:7420 --output=out \
    >told 2>err || fail "enroll: $(cat err)"
[ "$(ls out | wc -l)" = 20 ] || fail "folders: $(ls out)"
[ "$(grep -c '^worker:ws[0-9]*:k1 [0-9a-f]*$' keys)" = 20 ] || fail "$(cat keys)"
for h in $hosts; do
    grep -qxF "$(cat "out/$h/key")" keys || fail "$h: another key"
    [ "$(stat -c %a "out/$h/key")" = 600 ] || fail "$h: others read its key"
    [ "$(stat -c %a "out/$h/radd.conf")" = 644 ] || fail "$h: radd.conf's mode"
    grep -qx 'coordinator = render:7420' "out/$h/radd.conf" ||
        fail "$h: $(cat "out/$h/radd.conf")"
done
[ "$(stat -c %a out)" = 700 ] || fail "out: mode $(stat -c %a out)"
grep -q '^ws20  *worker:ws20:k1  *now' told || fail "table: $(cat told)"
grep -q 'scp out/WORKER/radd.conf out/WORKER/key root@WORKER:' told ||
    fail "what to do: $(cat told)"
grep -qE '[0-9a-f]{64}' told && fail "a secret is told"

# again, and from the key file alone, and one more: each keeps its key
cp keys before
rm -r out/ws03
"$radctl" --json enroll ws03 ws04 ws21 ws21 --keys=keys \
    --coordinator='[fd00::1]:99' --output=out >json || fail "again"
python3 - <<'END' || fail "$(cat json)"
import json
rows = [(r["worker"], r["key"], r["made"]) for r in json.load(open("json"))]
assert rows == [("ws03", "worker:ws03:k1", "before"),
                ("ws04", "worker:ws04:k1", "before"),
                ("ws21", "worker:ws21:k1", "now"),
                ("ws21", "worker:ws21:k1", "before")], rows
END
head -n 20 keys | cmp -s - before || fail "a key has changed"
[ "$(wc -l <keys)" = 21 ] || fail "keys: $(wc -l <keys)"
grep -qxF "$(cat out/ws03/key)" keys || fail "ws03: another key"
grep -qxF 'coordinator = [fd00::1]:99' out/ws04/radd.conf || fail "no new address"
# one that was retired gets another
"$radctl" key retire worker:ws04 --keys=keys >/dev/null
"$radctl" enroll ws04 --keys=keys --coordinator=render --output=out >told ||
    fail "after retire"
grep -q '^worker:ws04:k2 ' out/ws04/key || fail "ws04: $(cut -d' ' -f1 out/ws04/key)"
grep -qx 'coordinator = render:7420' out/ws04/radd.conf || fail "no default port"

expect 64 "enroll needs --output" "no folder" "$radctl" enroll ws01 --keys=keys
expect 64 "must say where workers dial" "no address" \
    "$radctl" enroll ws01 --keys=keys --output=out
expect 64 "must say where workers dial" "a socket" \
    "$radctl" enroll ws01 --keys=keys --output=out --coordinator=/run/x
for bad in .. a/b 'a b' .x; do
    expect 64 "a worker's name needs" "name $bad" "$radctl" enroll "$bad" \
        --keys=keys --output=out --coordinator=x
done
expect 64 "--output goes with enroll" "output of jobs" "$radctl" jobs --output=out

# by a coordinator, as an administrator; the workers join with what was made
"$radctl" key add admin:root --keys=keys >admin || fail "admin"
chmod 600 admin
"$radcoord" --listen=127.0.0.1:0 --socket="$work/socket" --state="$work/state" \
    --keys=keys --ports-file=ports --log-level=err 2>coord.err &
until_true 10 test -s ports || fail "radcoord: $(cat coord.err)"
address=$(sed -n 's/^tcp //p' ports)
enroll()
{
    "$radctl" --coordinator="$address" --key=admin enroll "$@"
}
enroll new1 new2 --output=made >told 2>err || fail "coordinator: $(cat err)"
grep -q "'127.0.0.1' is each host itself" err || fail "no warning: $(cat err)"
cp made/new1/key first
enroll new1 --output=made >told 2>err || fail "again: $(cat err)"
cmp -s first made/new1/key || fail "another key the second time"
rm made/new2/key
expect 73 "has a key, but not in" "a lost key" enroll new2 --output=made
"$radctl" key add user:ana --keys=keys >ana && chmod 600 ana
until_true 10 "$radctl" --coordinator="$address" --key=ana status ||
    fail "the user's key is not taken"
expect 77 "administrators" "as a user" "$radctl" --coordinator="$address" \
    --key=ana enroll ws30 --output=made
sed -i 's/^listen.*/listen = 127.0.0.1:0/' made/new1/radd.conf
"$radd" --config=made/new1/radd.conf --key=made/new1/key --threads=1 \
    --cache="$work/cache" --log-level=err 2>radd.err &
joined()
{
    "$radctl" --coordinator="$work/socket" workers | grep -q '^new1  *idle'
}
until_true 10 joined || fail "it does not join: $(cat radd.err coord.err)"
finish
