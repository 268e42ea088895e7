#!/bin/bash
# booted.sh - in a container that systemd has booted, with radd's packages: are
# the daemons up, do they come back, does an upgrade lose a job?  The last line
# is "all of it" if so.
set -u
export RADD_COORDINATOR=/run/radd/radcoord.sock

die()
{
    echo "FAILED: $*"
    journalctl --no-pager -n 30 -u radcoord -u radd
    exit 1
}

# Try a command again and again, for two minutes at most.
within()
{
    local i
    for i in {1..600}; do
        "$@" >/dev/null 2>&1 && return
        sleep .2
    done
    die "not within two minutes: $*"
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

for unit in radcoord radd; do
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
