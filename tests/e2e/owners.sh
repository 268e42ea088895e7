#!/bin/sh
# owners.sh - who comes by key and who comes by the Unix socket is one person,
# with one set of jobs; what a release kept under "uid:N" is theirs, too; and no
# key of a user is root
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

owner_of()
{
    "$radctl" --coordinator="$sock" --json job "$1" 2>stderr | python3 -c '
import json, sys
print(json.load(sys.stdin)["owner"])'
}

# submit NAME COMMAND...: the id of a job that COMMAND makes
submit()
{
    name=$1
    shift
    "$@" --detach --name="$name" -vf "$scenes/room.vf" -x 8 -y 8 \
        "$scenes/room.rad" 2>stderr || fail "$name: $(cat stderr)"
}

# is OWNER ID
is()
{
    found=$(owner_of "$2")
    [ "$found" = "$1" ] || fail "job $2 is of '$found', not of '$1'"
}

me=$(id -un)
other=nobody
[ "$me" != nobody ] || other=daemon
make_keys
make_key "user:$me" me.key
make_key "admin:$me" boss.key
make_key user:bob.smith bob.key
make_key "user:$other" none.key
chmod 755 "$work"
coord_options="--logins=$other=-,bob.smith=$other"
coord_start
id=$(submit socket "$radsubmit" --coordinator="$sock")
is "$me" "$id"
# the daemon's own user is an administrator: not by a key of a user
over=$(submit over "$radsubmit" --coordinator="$tcp" --key="$work/me.key")
is "user:$me" "$over"
expect 77 "belongs to another user" "a user's key of an administrator's name" \
    "$radctl" --coordinator="$tcp" --key="$work/me.key" cancel "$id"
is "$me" "$(submit admin "$radsubmit" --coordinator="$tcp" \
    --key="$work/boss.key")"
is "user:$other" "$(submit none "$radsubmit" --coordinator="$tcp" \
    --key="$work/none.key")"
key=$(submit key "$radsubmit" --coordinator="$tcp" --key="$work/bob.key")
is "$other" "$key"

if [ "$(id -u)" -eq 0 ] && command -v setpriv >/dev/null; then
    mkdir their && chmod 777 their
    as_other()
    {
        HOME=$work/their XDG_CONFIG_HOME=$work/their TMPDIR=$work/their \
            setpriv --reuid="$other" --clear-groups "$@"
    }
    there=$(submit there as_other "$radsubmit" --coordinator="$sock")
    is "$other" "$there"
    # each steers the other's
    as_other "$radctl" --coordinator="$sock" cancel "$key" ||
        fail "on the socket bob may not cancel what he made by key"
    "$radctl" --coordinator="$tcp" --key="$work/bob.key" pause "$there" ||
        fail "by key bob may not pause what he made on the socket"
    grep -q "job paused job=$there by=$other\$" c.log ||
        fail "the log does not say who paused the job"
    expect 77 "belongs to another user" "of root" \
        as_other "$radctl" --coordinator="$sock" cancel "$id"
fi

# a state folder of before, with numbers in place of logins
kill -TERM "$coord_pid"
wait "$coord_pid" || fail "the coordinator ended with $?"
python3 - "$id" "$(id -u)" <<'EOP' || fail "the database cannot be changed"
import sqlite3, sys
db = sqlite3.connect("state/radcoord.db")
n = db.execute("UPDATE job SET owner = ? WHERE id = ?",
               ("uid:" + sys.argv[2], bytes.fromhex(sys.argv[1]))).rowcount
db.commit()
sys.exit(n != 1)
EOP
coord_start
is "$me" "$id"
is "$other" "$key"

expect 64 "'logins': 'bob': expected KEY=LOGIN" "a bad map" \
    "$radcoord" --listen= --socket="$work/x.sock" --state="$work/x" \
    --logins=$other=-,bob
cluster_finish
