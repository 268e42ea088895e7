#!/bin/sh
# daemon_settings.sh - what is wrong in a settings file is told by file and line,
# an option by itself; what SIGHUP takes over and what waits for a restart; and
# where "*" and a name listen
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

# refused PROGRAM KEY VALUE TEXT: by its line in a file, and as an option
refused()
{
    program=$1 key=$2 value=$3
    printf '# one line above\n%s = %s\n' "$key" "$value" >bad.conf
    expect 78 "bad.conf:2: '$key': $4" "$key in a file" \
        "$top_builddir/$program" --config=bad.conf
    expect 64 "'$key': $4" "$key as an option" "$top_builddir/$program" \
        "--$(echo "$key" | tr _ -)=$value"
    grep -q bad.conf stderr && fail "$key as an option: blames a file"
}

for program in radcoord radd; do
    refused $program log_level loud "expected err, warn, info or debug"
    refused $program listen nowhere "expected HOST:PORT"
    refused $program listen 127.0.0.1:70000 "'127.0.0.1:70000': a port"
done
refused radcoord listen ./path "expected ADDR:PORT, got './path'"
refused radcoord keep_jobs many "bad number"
refused radd coordinator nowhere "expected HOST:PORT"
refused radd sandbox off "expected auto or required"
refused radd hours whenever "hours are like"
refused radd threads 4096 "4096 is not within"
refused radd idle_only perhaps "expected yes or no"
refused radd name "$(printf '%0100d' 0)" "longer than"
refused radd name "a b" "'a b': a worker's name needs letters"
refused radd cache "" "expected a folder"
refused radcoord state "" "expected a folder"
refused radcoord socket "$(printf '%0150d' 0)" "socket path too long"
refused radcoord logins ana "'ana': expected KEY=LOGIN"
refused radcoord logins ana=bob=carl "'bob=carl' is no login"

# a credential that cannot be read is not as if there were none
mkdir credentials
for name in keys key; do
    ln -s $name credentials/$name
done
expect 66 "credentials/keys': Too many" "a credential" env \
    CREDENTIALS_DIRECTORY="$work/credentials" "$radcoord" --config=/dev/null \
    --listen= --socket="$work/x.sock" --state="$work/x"
expect 66 "credentials/key': Too many" "a credential of radd" env \
    CREDENTIALS_DIRECTORY="$work/credentials" "$radd" --config=/dev/null \
    --listen=127.0.0.1:0 --coordinator=127.0.0.1:1 --cache="$work/y"

# settings that do not go together
printf 'idle_only = yes\nnice = 0\n' >pair.conf
expect 78 "pair.conf: idle_only needs nice above 0" "a pair in a file" \
    "$radd" --config=pair.conf
expect 64 "idle_only needs nice above 0" "a pair of options" \
    "$radd" --idle-only=yes --nice=0
printf 'listen =\nsocket =\n' >pair.conf
expect 78 "pair.conf: neither" "no socket in a file" \
    "$radcoord" --config=pair.conf
expect 64 "idle_only needs" "an option over a file" \
    "$radd" --config=/dev/null --idle-only --nice=0

# the client's file
mkdir -p "$XDG_CONFIG_HOME/radd"
client=$XDG_CONFIG_HOME/radd/radsubmit.conf
printf '\ncoordinator = here:99999999\n' >"$client"
expect 78 "radsubmit.conf:2: bad coordinator address" "a client's file" \
    "$radctl" status
printf 'coordinator = fe80::1%%eth0\n' >"$client"
expect 78 "radsubmit.conf:1: 'fe80::1%eth0': an IPv6 address stands in" \
    "a bare IPv6 address in a client's file" "$radctl" status
printf 'key = %0400d\n' 0 >"$client"
expect 78 "radsubmit.conf:1: line longer than" "a long value in a client's file" \
    "$radctl" status
printf 'key = x\nname = y\n' >"$client"
expect 78 "radsubmit.conf:2: unknown key" "a strange key in a client's file" \
    "$radctl" status
if [ "$(id -u)" -ne 0 ]; then # root may read anything
    chmod 0 "$client"
    expect 78 "cannot open '$client': Permission denied" "a client's file" \
        "$radctl" status
    chmod 0 "$XDG_CONFIG_HOME/radd"
    expect 69 "no coordinator is named" "another user's home" "$radctl" status
    chmod 700 "$XDG_CONFIG_HOME/radd"
fi
rm -f "$client"
while read -r program words; do
    # shellcheck disable=SC2086 # some words
    expect 64 "'::1:7420': an IPv6 address stands in brackets" "$program" \
        "$top_builddir/$program" --coordinator=::1:7420 $words
done <<'END'
radd
radweb
radctl status
radsubmit -o x.hdr x.rad
END

# a ports file: a link is followed, and what is no file is written as it is
# ports FILE: by a coordinator of that ports file
ports()
{
    "$radcoord" --listen= --socket="$work/p.sock" --state="$work/pstate" \
        --ports-file="$1" 2>"$work/p.log" &
    ports_pid=$!
}
mkdir ports
ln -s ports/real link
ports link
wait_file ports/real
[ -L link ] || fail "the link of a ports file was replaced"
[ "$(cat ports/real)" = "unix $work/p.sock" ] ||
    fail "ports file: $(cat ports/real)"
end_one $ports_pid "coordinator of a link"
mkfifo fifo
ports fifo
[ "$(timeout 100 cat fifo)" = "unix $work/p.sock" ] || fail "nothing in a fifo"
[ -p fifo ] || fail "the fifo of a ports file was replaced"
end_one $ports_pid "coordinator of a fifo"
ln -s /dev/full full
expect 74 "cannot write 'full'" "a ports file on a full device" \
    "$radcoord" --listen= --socket="$work/p.sock" --state="$work/pstate" \
    --ports-file=full

for program in radd radcoord radweb; do
    expect 74 "$program: cannot write: No space left" "$program --help" \
        sh -c "'$top_builddir/$program' --help >/dev/full"
done

# users find a socket, whatever the umask of who starts the daemon
(umask 077 && exec "$radcoord" --listen= --socket="$work/made/by/p.sock" \
    --state="$work/pstate" --ports-file="$work/made.ports" 2>"$work/p.log") &
ports_pid=$!
wait_file "$work/made.ports"
for folder in made made/by; do
    [ "$(stat -c %a $folder)" = 755 ] ||
        fail "the socket's folder $folder has mode $(stat -c %a $folder)"
done
[ "$(stat -c %a pstate)" = 700 ] || fail "pstate: $(stat -c %a pstate)"
end_one $ports_pid "coordinator of a new folder"

# all addresses of the machine, by both kinds where there are both
make_keys
log=$work/c.log
printf 'listen = *:0\nkeep_jobs = 50\n' >radcoord.conf
"$radcoord" --config=radcoord.conf --keys="$work/keys" --state="$work/state" \
    --socket="$work/c.sock" --ports-file="$work/c.ports" 2>"$log" &
coord_pid=$!
wait_file "$work/c.ports"
port=$(sed -n 's/^tcp .*:\([0-9]*\)$/\1/p' "$work/c.ports")
asked()
{
    "$radctl" --coordinator="$1:$port" --key="$work/admin.key" status \
        >/dev/null 2>stderr || fail "$1 does not answer: $(cat stderr)"
}
asked 127.0.0.1
asked 127.0.0.9
if grep -q '^tcp \[::\]' "$work/c.ports" && [ -e /proc/net/if_inet6 ] &&
    grep -q ' lo$' /proc/net/if_inet6; then
    asked '[::1]'
else
    echo "no IPv6 here: [::1] is not tried"
fi

# a worker finds it by a name whose first address may be of the other kind
printf 'coordinator = localhost:%s\nthreads = 1\nname = ws1\n' "$port" >radd.conf
"$radctl" key add worker:ws1 --keys="$work/keys" >ws1.key || fail "no key"
chmod 600 ws1.key
"$radd" --config=radd.conf --key=ws1.key --listen=127.0.0.1:0 \
    --cache="$work/cache" --idle-only=no 2>"$work/w.log" &
worker=$!
sock=$work/c.sock
until_true 30 n_workers 1 || fail "no worker: $(cat "$work/w.log")"

# lines have a time, where no journal gives them one
grep -qE '^[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9:]{8}\.[0-9]{3}[+-][0-9]{4} radcoord' \
    "$log" || fail "no time in the log: $(head -n 1 "$log")"

# SIGHUP: what is taken over, and what is not, by name
reloaded()
{
    [ "$(grep -c 'reloaded$' "$1")" -ge "$2" ]
}
kill -HUP $coord_pid $worker
until_true 10 reloaded "$log" 1 || fail "no reload: $(cat "$log")"
until_true 10 reloaded "$work/w.log" 1 || fail "no reload: $(cat "$work/w.log")"
grep -q 'after a restart' "$log" "$work/w.log" &&
    fail "nothing changed, but a restart is asked for"
printf 'listen = 127.0.0.1:0\nkeep_jobs = 60\n' >radcoord.conf
printf 'coordinator = localhost:1\nthreads = 2\nname = ws2\ncache = /x\n' \
    >radd.conf
kill -HUP $coord_pid $worker
until_true 10 reloaded "$log" 2 || fail "no reload: $(cat "$log")"
until_true 10 reloaded "$work/w.log" 2 || fail "no reload: $(cat "$work/w.log")"
grep -q 'only after a restart keys=listen$' "$log" ||
    fail "the coordinator does not say what waits: $(cat "$log")"
grep -q 'only after a restart keys=coordinator,name,threads$' "$work/w.log" ||
    fail "the worker does not say what waits: $(cat "$work/w.log")"

# a key file that cannot be changed is an event
ln "$work/keys" "$work/second"
expect 77 "several names" "a key file of two names" \
    "$radctl" --coordinator="$sock" key add user:bo
grep -q 'key file not changed name=user:bo why=' "$log" ||
    fail "the log does not tell: $(cat "$log")"
end_one $worker worker
end_one $coord_pid coordinator
finish
