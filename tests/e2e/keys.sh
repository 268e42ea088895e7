#!/bin/sh
# keys.sh - radctl and a key file, without a coordinator
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

"$radctl" key add worker:ws07 --keys=keys >line || fail "key add"
[ "$(stat -c %a keys)" = 600 ] || fail "mode $(stat -c %a keys)"
grep -qE '^worker:ws07:k1 [0-9a-f]{64}$' line || fail "line: $(cat line)"
cmp -s line keys || fail "the line is not the file's"
echo '# a note' >>keys
"$radctl" key add user:ana --expires=2127-01-31 --keys=keys >line ||
    fail "key add"
grep -qE '^user:ana:k1 [0-9a-f]{64} 2127-01-31$' line || fail "$(cat line)"
"$radctl" --json key add worker:ws07 --keys=keys >json || fail "json"
python3 -c '
import json
j = json.load(open("json"))
assert j["key"] == "worker:ws07:k2", j
assert j["line"] in open("keys").read().split("\n"), j' || fail "json"
"$radctl" key retire worker:ws07:k1 --keys=keys >/dev/null || fail "retire"
"$radctl" key list --keys=keys >list || fail "list"
grep -qE '^worker:ws07:k1 .*retired' list || fail "list: $(cat list)"
grep -qE '^worker:ws07:k2 .*valid' list || fail "list: $(cat list)"
grep -qE '[0-9a-f]{64}' list && fail "the list shows secrets"
grep -q '^# a note$' keys || fail "a comment is gone"
grep -q '^worker:ws07:k1 retired$' keys || fail "the secret stays"

expect 64 "names no key" "no role" "$radctl" key add ana --keys=keys
expect 64 "observer:" "a role that is none" "$radctl" key add foo:a --keys=new
[ ! -e new ] || fail "a file was made for a key that is none"
expect 64 "date" "no date" "$radctl" key add user:a --expires=soon --keys=keys
cp keys before
expect 64 "past" "a date that is over" \
    "$radctl" key add user:a --expires=2024-01-01 --keys=keys
cmp -s keys before || fail "a refused key is there"
rm before
expect 64 "expires" "date of a list" \
    "$radctl" key list --expires=2027-01-01 --keys=keys
expect 64 "missing" "no name" "$radctl" key add --keys=keys
expect 64 "key drop" "no such order" "$radctl" key drop user:a --keys=keys
expect 64 "--keys" "keys of a job" "$radctl" jobs --keys=keys
expect 66 "no key" "unknown" "$radctl" key retire user:bo --keys=keys
expect 66 "" "no file" "$radctl" key list --keys=nowhere
chmod 640 keys
expect 77 "chmod 600" "open to the group" "$radctl" key list --keys=keys
chmod 600 keys
echo 'worker:ws08:k1 abc' >>keys
expect 78 "keys:5" "a bad line" "$radctl" key add user:bo --keys=keys

# of many at once none is lost
rm keys
for i in 1 2 3 4 5 6 7 8; do
    "$radctl" key add user:u$i --keys=keys >/dev/null &
done
wait
[ "$(grep -c '^user:u' keys)" -eq 8 ] || fail "keys were lost: $(cat keys)"
[ "$(ls keys*)" = keys ] || fail "left over: $(ls keys*)"
finish
