#!/bin/bash
# booted.sh - in a container that systemd has booted, with radd's packages: are
# the daemons up, do they come back, does an upgrade lose a job?  The last line
# is "all of it" if so.
set -u
export RADD_COORDINATOR=/run/radd/radcoord.sock

die()
{
    echo "FAILED: $*"
    journalctl --no-pager -n 30 -u radcoord -u radd -u radweb
    exit 1
}

# Try a command again and again, for ten minutes at most.
within()
{
    local i
    for i in {1..3000}; do
        "$@" >/dev/null 2>&1 && return
        sleep .2
    done
    die "not within ten minutes: $*"
}

as_ana()
{
    runuser -u ana -- env HOME=/home/ana sh -c "cd && $*"
}

view='-vp 2 1 1.5 -vd 0 1 0'
worker_there() { radctl --json workers | grep -q '"state": *"\(idle\|busy\)"'; }
restarted() { [ "$(systemctl show -p MainPID --value "$1")" != "$2" ] &&
    systemctl is-active -q "$1"; }

killed()
{
    local pid
    pid=$(systemctl show -p MainPID --value "$1")
    kill -KILL "$pid"
    within restarted "$1" "$pid"
    echo "$1 came back after SIGKILL"
}

within systemctl is-active -q radcoord
within systemctl is-active -q radd
within worker_there
as_ana radsubmit "$view" -x 64 -y 64 -ab 1 -o a.hdr room.rad || die "a picture"
killed radcoord
killed radd
within worker_there

# radweb, as its manual page has it: on this machine, then with TLS and a token
# for all; no other user can read the certificate's key
umask 077
cd /etc/radd || die "no /etc/radd"
radctl key add observer:page --keys=keys >radweb.key || die "observer's key"
systemctl enable -q radweb && systemctl restart radcoord radweb || die "radweb"
page_up() # CURL'S OPTIONS
{
    curl -fs --max-time 5 "$@/api/v1/status.json" | grep -q '"up": *true'
}
within page_up http://127.0.0.1:7480
[ "$(ps -o ni=,cls= -p "$(systemctl show -p MainPID --value radweb)" |
    tr -s ' ')" = " 15 B" ] || die "radweb's priority"
killed radweb
within page_up http://127.0.0.1:7480
token=$(openssl rand -hex 24)
echo "$token" >radweb.token
openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=render \
    -addext 'subjectAltName=DNS:render,IP:127.0.0.1' -keyout radweb.tls-key \
    -out radweb.tls-cert >/dev/null 2>&1 || die "a certificate"
echo 'listen = 0.0.0.0:7480' >>radweb.conf
systemctl restart radweb
secure=(--cacert radweb.tls-cert -u "me:$token")
within page_up "${secure[@]}" https://127.0.0.1:7480
page_up --cacert radweb.tls-cert https://127.0.0.1:7480 &&
    die "a page without its token"
page_up -u "me:$token" http://127.0.0.1:7480 &&
    die "a page without TLS"
[ "$(stat -c %a radweb.tls-key)" = 600 ] || die "the key's mode"
killed radweb
within page_up "${secure[@]}" https://127.0.0.1:7480
umask 022
cd /
within worker_there
echo "radweb: TLS and a token"

for unit in radcoord radd radweb; do
    level=$(systemd-analyze security --no-pager $unit | sed -n \
        's/.*exposure level[^:]*: *\([0-9.]*\).*/\1/p')
    echo "$unit: exposure $level"
    awk -v l="$level" 'BEGIN { exit !(l > 0 && l <= 1.5) }' ||
        die "$unit is exposed"
done

# a job is in the queue, and one is under way, while the packages change
job=$(as_ana radsubmit "$view" -x 900 -y 900 -ps 1 -ab 2 -ad 256 -aa .15 \
    --detach room.rad | grep -oE '[0-9a-f]{32}') || die "detach"
second=$(as_ana radsubmit "$view" -x 64 -y 64 -ab 1 --detach room.rad |
    grep -oE '[0-9a-f]{32}') || die "detach"
under_way() { radctl --json job "$job" | grep -q '"state": *"running"'; }
within under_way
apt-get install -y -q --no-install-recommends /root/next/*.deb >/root/apt.log \
    2>&1 || die "upgrade: $(tail /root/apt.log)"
dpkg -s radcoord | grep -q '^Version:.*+next' || die "no upgrade"
within as_ana radctl fetch "$job" -o b.hdr
within as_ana radctl fetch "$second" -o c.hdr
cmp <(sed 1,/^$/d /home/ana/a.hdr) <(sed 1,/^$/d /home/ana/c.hdr) ||
    die "another picture"
echo "jobs outlived the upgrade"

systemctl stop radd
journalctl --no-pager -u radd | grep -q 'let go by the coordinator' ||
    die "stopped without handing over"
systemctl start radd
within worker_there
dpkg --remove radd radcoord radweb radd-client radd-doc >/dev/null 2>&1 || die "remove"
[ -d /var/lib/radd ] || die "jobs went with remove"
dpkg --purge radd radcoord >/dev/null 2>&1 || die "purge"
[ ! -e /var/lib/radd ] && [ ! -e /var/cache/radd ] || die "left by purge"
echo "all of it"
