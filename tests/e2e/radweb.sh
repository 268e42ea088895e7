#!/bin/sh
# radweb.sh - what radweb says is what radctl says; names of others stay text;
# garbage, slow and many browsers take no more than their bounds, and the
# coordinator does not notice; who may come from where
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
command -v python3 >/dev/null || {
    echo "SKIP: no python3 here"
    exit 77
}
radweb=$top_builddir/radweb
view="-vf $scenes/room.vf -x 80 -y 60"

# web_start OPTION...: its address in $url, its process in $web
web_start()
{
    rm -f web.ports
    "$radweb" --coordinator="$tcp" --key="$work/page.key" \
        --listen=127.0.0.1:0 --ports-file="$work/web.ports" "$@" \
        2>>web.log &
    web=$!
    wait_file web.ports
    url=$(tr -s ' ' / <web.ports | sed 's|/|://|')
}

# try NAME...: a part of tests/web/ask.py; ask: one that must hold
try()
{
    python3 "$top_srcdir/tests/web/ask.py" "$@"
}
ask()
{
    try "$@" || fail "$1"
}

make_keys
make_key observer:page page.key
coord_start
web_start
ask no_jobs "$url"
worker_start 1 2
until_true 30 n_workers 1 || fail "the worker does not come"

# names that are HTML, script, direction and more
evil='<script>alert(1)</script>"><img src=x onerror=alert(2)>&'\''`'
# shellcheck disable=SC2086 # options are words
id=$("$radsubmit" --coordinator="$tcp" --key="$work/user.key" $view \
    --name="$evil" --detach "$scenes/room.rad") || fail "submit"
cp "$scenes/room.rad" "x'; touch gone.rad"
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$tcp" --key="$work/user.key" $view -ab 1 \
    -o a.hdr "x'; touch gone.rad" 2>stderr || fail "submit: $(cat stderr)"
is_done()
{
    "$radctl" --coordinator="$tcp" --key="$work/admin.key" --json job "$id" |
        grep -q '"state": "done"'
}
until_true 60 is_done || fail "the job is not done"
"$radctl" --coordinator="$tcp" --key="$work/admin.key" fetch "$id" -o b.hdr ||
    fail "fetch"
ask same_as_radctl "$url" "$radctl" --coordinator="$tcp" \
    --key="$work/admin.key" --json
ask names_stay_text "$url" "$id"
ask heard "$url" "$id"
ask picture_is_the_job_s "$url" "$id" b.hdr
ask metrics "$url"
ask headers "$url" "$id"
ask not_this_machine "$url"
# its owner has not fetched it by that
"$radctl" --coordinator="$tcp" --key="$work/admin.key" --json job "$id" >one
grep -q 'not fetched' one || fail "what an observer fetched counts"

# a shell takes the command line for words, and makes the same picture again
ask command "$url" >command
(sh -n command) || fail "the command line is no shell's"

ask gone "$url" "$id" "$radctl" --coordinator="$tcp" --key="$work/admin.key" \
    delete "$id"

# --- those who mean harm ---
ask garbage "$url"
try slow "$url" &
slow=$!
ask many "$url" "$web" "$radctl" --coordinator="$tcp" \
    --key="$work/user.key" status
wait $slow || fail "those who are slow stay"
ask flood "$url" "$web" "$radctl" --coordinator="$tcp" \
    --key="$work/user.key" status
kill -0 "$web" || fail "radweb has ended: $(tail -5 web.log)"
# it sleeps, and is killed, while a job is looked at: the job does not notice
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$tcp" --key="$work/user.key" $view -ab 1 -ad 256 \
    -o looked.hdr "$scenes/room.rad" 2>stderr &
job=$!
"$radsubmit" --local $view -ab 1 -ad 256 -o alone.hdr "$scenes/room.rad" \
    2>/dev/null || fail "local"
ask alive "$url"
kill -STOP "$web"
ask stalled "$url" "$radctl" --coordinator="$tcp" --key="$work/user.key" status
kill -CONT "$web"
ask alive "$url"
kill -9 "$web"
wait "$web"
wait $job || fail "a job while radweb is killed: $(cat stderr)"
cmp looked.hdr alone.hdr || fail "a picture that was looked at is another"
web_start

# it stops with pages open, and the coordinator may come and go
try restart_begin "$url" open &
page=$!
until_true 10 test -e open || fail "no page is open"
until_true 20 try has_data "$url" || fail "it has heard of no coordinator"
# shellcheck disable=SC2154 # of cluster.sh
kill "$pid_1" "$coord_pid"
wait "$pid_1" "$coord_pid"
until_true 20 try away "$url" || fail "the page does not say that it is away"
ask grows_old "$url"
ask comes_again "$url"
coord_again
until_true 40 try back "$url" || fail "it does not dial again"
kill "$web"
wait "$web" || fail "exit status $? when it is stopped"
wait $page || fail "a page that was open does not end"
grep -q 'observer' c.log || fail "the log does not say who came"

# --- who may come from where ---
expect 77 "that takes tls_cert" "the world without TLS" "$radweb" \
    --listen=0.0.0.0:0 --coordinator="$tcp"
echo 'a token of many words' >short
expect 78 "at least 16" "a short token" "$radweb" --listen=127.0.0.1:0 \
    --token-file=short
expect 77 "that takes a token" "the world without a token" "$radweb" \
    --listen=0.0.0.0:0 --proxy --coordinator="$tcp"
expect 64 "without the other" "half a certificate" "$radweb" --tls-cert=x
expect 66 "none" "no certificate" "$radweb" --listen=127.0.0.1:0 \
    --tls-cert=none --tls-key=none
echo 0123456789abcdef0123 >token
web_start --token-file="$work/token"
ask token "$url" 0123456789abcdef0123
kill "$web" && wait "$web"
if openssl req -x509 -newkey rsa:2048 -nodes -keyout tls.key -out tls.crt \
    -days 2 -subj /CN=localhost >/dev/null 2>&1; then
    web_start --tls-cert=tls.crt --tls-key=tls.key --token-file="$work/token"
    ask tls "$url" 0123456789abcdef0123
    kill "$web" && wait "$web"
fi
# a key of another role is refused, and radweb says so
web_start --key="$work/user.key"
until_true 20 grep -q 'role is not allowed' web.log || fail "a user's key"
until_true 20 try away "$url" || fail "it shows a cluster by a user's key"
kill "$web" "$coord_pid"
wait "$web" "$coord_pid"
finish
