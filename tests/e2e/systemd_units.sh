#!/bin/sh
# systemd_units.sh - the units are sound and hardened, what they allow is enough
# to render with, and the daemons tell systemd what it waits for
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

room=$scenes/room.rad
view="-vf $scenes/room.vf -x 64 -y 48"

# --- what the daemons say ---

# Each line is "PID WORD=VALUE", of whoever says it.
cat >listener.py <<'EOF'
import socket, struct, sys
s = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
s.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
s.bind(sys.argv[1])
with open(sys.argv[2], "w", buffering=1) as log:
    while True:
        text, creds, _, _ = s.recvmsg(4096, socket.CMSG_SPACE(12))
        pid = struct.unpack("3i", creds[0][2])[0]
        for line in text.decode().splitlines():
            log.write("%d %s\n" % (pid, line))
EOF
python3 listener.py notify said & # not by the folder's name: no daemon
listener=$!
until_true 10 test -S "$work/notify" || fail "nobody listens"
export NOTIFY_SOCKET="$work/notify" WATCHDOG_USEC=500000
cluster_start 2 1
unset NOTIFY_SOCKET WATCHDOG_USEC
all_say()
{
    for pid in "$coord_pid" "$pid_1" "$pid_2"; do
        grep -q "^$pid $1" said || return 1
    done
}
until_true 10 all_say READY=1 || fail "not all say that they are ready"
until_true 10 all_say WATCHDOG=1 || fail "no sign of life for the watchdog"
kill -STOP "$pid_1" "$coord_pid"
both_stand()
{
    [ "$(ps -o stat= -p "$pid_1,$coord_pid" | grep -c '^T')" -eq 2 ]
}
until_true 10 both_stand || fail "they do not stop for SIGSTOP"
# what they said before comes before this
python3 -c 'import socket, sys
socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM).sendto(b"STOPPED", sys.argv[1])
' notify
until_true 10 grep -q ' STOPPED' said || fail "the listener is not there"
since_stopped()
{
    sed '1,/ STOPPED/d' said
}
often() # the other worker has given so many signs of life meanwhile
{
    [ "$(since_stopped | grep -c "^$pid_2 WATCHDOG")" -ge 5 ]
}
until_true 10 often || fail "worker 2 gives no signs of life"
since_stopped | grep -q -e "^$pid_1 WATCHDOG" -e "^$coord_pid WATCHDOG" &&
    fail "one that hangs says it lives"
kill -CONT "$pid_1" "$coord_pid"
kill -HUP "$pid_1"
until_true 10 grep -q "^$pid_1 RELOADING=1" said || fail "no word of reloading"
cluster_stop
until_true 10 all_say STOPPING=1 || fail "not all say that they stop"
kill $listener

export NOTIFY_SOCKET="$work/nobody"
coord_start
unset NOTIFY_SOCKET
grep -q "warn: systemd not reached at=$work/nobody why=no such file" c.log ||
    fail "no word of a systemd that is not there: $(cat c.log)"
cluster_stop

# --- what systemd says ---

if ! systemd-analyze --version >/dev/null 2>&1; then
    echo "SKIP: no systemd-analyze here; the units are not checked"
    finish
fi
for unit in radd radcoord radweb; do
    sed "s|@sbindir@|$top_builddir|; s|@sysconfdir@|/etc|" \
        "$top_srcdir/etc/$unit.service.in" >$unit.service
    systemd-analyze verify --man=no "$work/$unit.service" 2>verify ||
        fail "$unit.service: $(cat verify)"
    # of other units it says what it likes
    grep "$unit" verify && fail "$unit.service is not sound"
    systemd-analyze security --offline=true --threshold=15 \
        "$work/$unit.service" >security 2>&1 ||
        fail "$unit.service: $(tail -1 security)"
done

# --- and does ---

systemd-analyze syscall-filter >groups 2>/dev/null
# allowed UNIT: the names of the system calls that it allows
allowed()
{
    python3 - "$1" groups <<'EOF'
import sys
groups, name = {}, None
for line in open(sys.argv[2]):
    word = line.split("#")[0].strip()
    if line.startswith("@"):
        name = word.split()[0]
        groups[name] = []
    elif word and name:
        groups[name].append(word)
def members(word):
    if not word.startswith("@"):
        return {word}
    return set().union(*[members(w) for w in groups.get(word, [])])
calls = set()
for line in open(sys.argv[1]):
    if line.startswith("SystemCallFilter="):
        words = line.split("=", 1)[1].strip()
        deny = words.startswith("~")
        for word in words.lstrip("~").split():
            calls = calls - members(word) if deny else calls | members(word)
print("\n".join(sorted(calls | members("@default"))))
EOF
}
for unit in radd radcoord; do
    for line in RestrictAddressFamilies='AF_UNIX AF_INET AF_INET6' \
        MemoryDenyWriteExecute=yes RestrictNamespaces=yes \
        CapabilityBoundingSet= ProtectSystem=strict UMask=0077; do
        grep -qx "$line" $unit.service || fail "$unit.service: no $line"
    done
    allowed $unit.service >$unit.calls
done
grep -qx OOMPolicy=continue radd.service || fail "a child takes radd with it"
# shellcheck disable=SC2086 # options are words
"$radsubmit" --local --threads=1 $view -o alone.hdr "$room" 2>stderr ||
    fail "embedded: $(cat stderr)"
confine=$top_builddir/tests/tools/confine
coord_program=$radcoord
worker_program=$radd
radcoord=confined_coord
radd=confined_worker
confined_coord()
{
    exec "$confine" radcoord.calls "$work" "$coord_program" "$@"
}
confined_worker()
{
    exec "$confine" radd.calls "$work" "$worker_program" "$@"
}
cluster_start 2 1
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" $view -o confined.hdr "$room" 2>stderr ||
    fail "confined: $(cat stderr c.log w1.log)"
cmp alone.hdr confined.hdr || fail "the picture of confined daemons differs"
grep -q '^Seccomp:.2' "/proc/$pid_1/status" || fail "radd was not confined"
grep -q 'sandbox incomplete' w1.log && fail "the child has no sandbox there"
cluster_finish
