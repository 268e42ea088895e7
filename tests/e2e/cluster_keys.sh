#!/bin/sh
# cluster_keys.sh - who gets in over TCP and who does not, and what is said of
# it; keys that come and go while a coordinator runs
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

coord_start
worker_start 1 1
until_true 30 n_workers 1 || fail "the worker does not come"

# once EXPECTED-IN-THE-LOG NAME: exactly one line more of a peer since the last
# call
seen=0
once()
{
    until_true 5 news_say "$1" || fail "$2: the log says $(news)"
    n=$(news | grep -c 'peer=127')
    [ "$n" -eq 1 ] || fail "$2: $n lines: $(news)"
    seen=$(wc -l <c.log)
}

news() { tail -n +$((seen + 1)) c.log; }

news_say() { news | grep -qF -e "$1"; }

# good NAME COMMAND...
good()
{
    name=$1
    shift
    "$@" >stdout 2>stderr </dev/null || fail "$name: $(cat stderr)"
}

# The right ones.
status() { "$radctl" --coordinator="$tcp" --key="$1" status; }
good "a user" status user.key
good "an admin" status admin.key
good "an admin's order" \
    "$radctl" --coordinator="$tcp" --key=admin.key drain w1
good "an admin's order" \
    "$radctl" --coordinator="$tcp" --key=admin.key undrain w1
# logged WORDS...: who came, and who did what
logged()
{
    for words in "$@"; do
        grep -q -e "$words\$" c.log || fail "the log lacks '$words'"
    done
}
logged 'role=user owner=[^ ]* protocol=1' 'role=admin owner=[^ ]* protocol=1' \
    'worker drained name=w1 by=[^ ]*' 'worker undrained name=w1 by=[^ ]*'
good "a user's job" "$radsubmit" --coordinator="$tcp" --key=user.key \
    -vf "$scenes/room.vf" -x 60 -y 40 -ab 0 -o over_tcp.hdr "$scenes/room.rad"
good "an admin's job" "$radsubmit" --coordinator="$tcp" \
    --key=admin.key -vf "$scenes/room.vf" -x 60 -y 40 -ab 0 \
    -o by_admin.hdr "$scenes/room.rad"
good "the same by the socket" "$radsubmit" --coordinator="$sock" \
    -vf "$scenes/room.vf" -x 60 -y 40 -ab 0 -o local.hdr "$scenes/room.rad"
cmp over_tcp.hdr local.hdr || fail "TLS changes the picture"
"$radctl" --coordinator="$tcp" --key=user.key --json jobs >jobs || fail "jobs"
grep -q '"owner": *"'$ana'"' jobs || fail "the job's owner is not the key's"

# The wrong ones: credential by credential, each once in the log.
umask 077
tr 0123456789abcdef 123456789abcdef0 <user.key |
    sed 's/^[^ ]* /user:ana:k1 /' >wrong.key
sed 's/:ana:/:bob:/' user.key >unknown.key
"$radctl" key add user:eve --keys=keys >retired.key
"$radctl" key retire user:eve --keys=keys >/dev/null
"$radctl" key add user:old --keys=keys >expired.key
sed -i '/^user:old:/s/$/ 2024-01-01/' keys expired.key
expect 64 "past" "a key that has expired" "$radctl" --coordinator="$tcp" \
    --key=admin.key key add user:older --expires=2024-01-01
kill -HUP "$coord_pid"
until_true 10 grep -q reloaded c.log || fail "no reload"
sleep 1.2 # the look at the file that comes each second
seen=$(wc -l <c.log)
expect 77 "does not take the key" "wrong secret" status wrong.key
once "wrong secret of key 'user:ana:k1'" "wrong secret"
expect 77 "does not take the key" "unknown name" status unknown.key
once "unknown key 'user:bob:k1'" "unknown name"
expect 77 "does not take the key" "retired key" status retired.key
once "retired key 'user:eve:k1'" "retired key"
expect 77 "does not take the key 'user:old:k1'; the key expired on 2024-01-01" \
    "expired key" status expired.key
once "expired key 'user:old:k1'" "expired key"
expect 77 "this role is not allowed" "worker's key" status w9.key
once "name=w9 why=this role is not allowed from there" "worker's key"
expect 77 "this role is not allowed" "a worker with a user's key" \
    "$radd" --coordinator="$tcp" --key=user.key --cache="$work/x" \
    --listen=127.0.0.1:0
once "name=$ana why=this role is not allowed from there" \
    "a worker with a user's key"
expect 77 "worker called 'w9'" "another worker's name" \
    "$radd" --coordinator="$tcp" --key=w9.key --name=w1 --cache="$work/x" \
    --listen=127.0.0.1:0
once "the key is that of a worker called 'w9'" "another worker's name"
expect 77 "a key" "no key" "$radctl" --coordinator="$tcp" status
once "connection refused peer=127" "no key"
python3 - "$tcp" <<'PYTHON' || fail "TLS 1.2 got in"
import socket, ssl, sys
host, port = sys.argv[1].split(':')
c = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
c.check_hostname = False
c.verify_mode = ssl.CERT_NONE
c.maximum_version = ssl.TLSVersion.TLSv1_2
try:
    c.wrap_socket(socket.create_connection((host, int(port))))
    sys.exit(1)
except ssl.SSLError:
    pass
PYTHON
once "an older version of TLS" "TLS 1.2"
sleep 10 & # of the limit on such lines
pause=$!

# What a user may not ask.
expect 77 "administrators" "a user who drains" \
    "$radctl" --coordinator="$tcp" --key=user.key drain w1
expect 77 "administrators" "a user who makes keys" \
    "$radctl" --coordinator="$tcp" --key=user.key key add admin:ana

# An observer sees everything and changes nothing.
(umask 077 && "$radctl" --coordinator="$tcp" --key=admin.key \
    key add observer:eye >eye.key) || fail "no key for an observer"
look() { "$radctl" --coordinator="$tcp" --key=eye.key "$@"; }
good "an observer" look status
good "an observer's list" look --json jobs
id=$(python3 -c 'import json; print(json.load(open("stdout"))[0]["job"])')
good "an observer's look at a user's job" look job "$id"
good "an observer's picture" look fetch "$id" -o seen.hdr
cmp seen.hdr over_tcp.hdr || fail "an observer gets another picture"
expect 77 "observers" "an observer who cancels" look cancel "$id"
expect 77 "observers" "an observer's priority" look priority "$id" 1
expect 77 "administrators" "an observer who drains" look drain w1

# A server with a certificate and no key gets not a byte of ours.
if command -v openssl >/dev/null; then
    openssl req -x509 -newkey rsa:2048 -nodes -keyout rogue.pem \
        -out rogue.crt -days 1 -subj /CN=radcoord 2>/dev/null
    python3 - >rogue.log <<'PYTHON' &
import socket, ssl
c = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
c.load_cert_chain('rogue.crt', 'rogue.pem')
s = socket.create_server(('127.0.0.1', 0))
print(s.getsockname()[1], flush=True)
while True:
    k, _ = s.accept()
    try:
        print('got', c.wrap_socket(k, server_side=True).recv(100), flush=True)
    except ssl.SSLError as e:
        print(e, flush=True)
PYTHON
    rogue=$!
    wait_file rogue.log
    expect 77 "certificate" "a rogue coordinator" "$radctl" \
        --coordinator="127.0.0.1:$(head -n 1 rogue.log)" --key=user.key status
    "$radd" --coordinator="127.0.0.1:$(head -n 1 rogue.log)" --key=w9.key \
        --cache="$work/x" --listen=127.0.0.1:0 --log-level=debug 2>w9.log &
    lured=$!
    until_true 10 grep -q certificate w9.log || fail "radd: $(cat w9.log)"
    kill $lured $rogue
    wait $lured $rogue 2>/dev/null
    grep -q "got b'RADD" rogue.log && fail "it was spoken to"
fi

# Keys by the coordinator: a new one counts at once, a retired one ends what is
# connected; with both keys of a rotation one can be there.
wait $pause
"$radctl" --coordinator="$tcp" --key=admin.key key add worker:w1 >new.key ||
    fail "key add"
grep -q '^worker:w1:k2 ' new.key || fail "the new key: $(cat new.key)"
cp new.key w1.key
n_workers 1 || fail "the old key is gone already"
"$radctl" --coordinator="$tcp" --key=admin.key key retire worker:w1:k1 \
    >/dev/null || fail "key retire"
until_true 5 grep -q 'connection closed peer=.*key=worker:w1:k1: retired' \
    c.log || fail "w1 stays: $(tail -n 3 c.log)"
back() { "$radctl" --coordinator="$sock" --json workers | grep -q '"idle"'; }
until_true 30 back || fail "w1 does not come back by its new key"
logged 'key added name=worker:w1 by=[^ ]*' \
    'key retired name=worker:w1:k1 by=[^ ]*'
"$radctl" --coordinator="$tcp" --key=admin.key key list >list || fail "list"
grep -q '^worker:w1:k1 .*retired' list || fail "list: $(cat list)"
grep -q "$(cut -d' ' -f2 new.key)" list && fail "the list shows a secret"

# A key that ends by itself.  On a busy machine it may have ended before it was
# used; then one that lasts longer.
ended() { grep -q "connection closed peer=.*key=$id: expired key" c.log; }
for s in 4 16 64; do
    "$radctl" --coordinator="$sock" key retire worker:w1 >/dev/null ||
        fail "key retire"
    "$radctl" --coordinator="$sock" key add worker:w1 \
        --expires="$(date -u -d "+$s seconds" +%Y-%m-%dT%H:%M:%SZ)" >w1.key ||
        fail "key add"
    id=$(cut -d' ' -f1 w1.key)
    until=$(($(date +%s) + s + 10))
    until ended || [ "$(date +%s)" -gt $until ]; do
        sleep .1
    done
    ended && break
done
ended || fail "no connection by $id ended with it"

# One that is edited away by hand.
make_key worker:w2 w2.key
worker_start 2 1
until_true 30 back || fail "w2 does not come"
sed -i '/^worker:w2:k2 /d' keys
until_true 5 grep -q 'key=worker:w2:k2: unknown key' c.log ||
    fail "a changed file was not noticed"
chmod 640 keys
until_true 5 grep -q 'keys not reloaded.*chmod 600' c.log ||
    fail "a file that all may read was taken"
chmod 600 keys

# Of a worker that is away the others are told, too, for it may have its links
# with them.
worker_start 3 1
until_true 30 grep -q 'hello .*name=w3' c.log || fail "w3 does not come"
end_one "$pid_3" "worker 3"
"$radctl" --coordinator="$sock" key retire worker:w3 >/dev/null ||
    fail "key retire"
until_true 5 grep -q 'worker expelled name=w3 key=worker:w3:k1: retired' c.log ||
    fail "w3 is not expelled: $(tail -n 3 c.log)"
[ "$(grep -c 'worker expelled name=w3' c.log)" -eq 1 ] || fail "w3: twice"

# One that is gone is not begun anew, with a key that shuts all others out; of a
# bad one the line is told.
mv keys away
expect 66 "No such file" "a key for a file that is gone" \
    "$radctl" --coordinator="$sock" key add user:new
[ ! -e keys ] || fail "the key file was begun anew"
mv away keys
echo nonsense >>keys
expect 78 "keys:$(wc -l <keys)" "a key for a file with a bad line" \
    "$radctl" --coordinator="$sock" key add user:new
cluster_finish
