#!/bin/sh
# reuse.sh - a job that begins with a former job's ambient cache (--reuse): a
# second view of a room takes few rays, and is the same bytes with one worker
# and with three, after its coordinator was killed, and when the former job is
# gone meanwhile; what does not fit is refused
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

room=$scenes/room.rad
first="-vf $scenes/room.vf"
second="$first -vp 2 2.2 1.4 -vd -.3 1 -.1"
third="$first -vh 90"
set -- -ab 3 -aa .15 -ar 32 -ad 128 -as 32
office=$top_srcdir/../shared/scenes/office
at=$work
if [ -d "$office" ]; then
    at=$office
    room=night.rad first="-vf norm.vf" second="-vf close.vf" third="-vf norm.vf -vh 30 -vv 30"
    set -- -ab 4 -aa .3 -ar 32 -ad 128 -as 32
fi

# submit NAME OPTION...
submit()
{
    cd "$at" && name=$1 && shift && exec "$radsubmit" --coordinator="$sock" \
        --name="$name" -x 200 -y 200 --stats="$work/$name.json" \
        -o "$work/$name.hdr" "$@" "$room" 2>"$work/$name.err"
}

# job NAME OPTION...: to its end; $id is its id
job()
{
    name=$1
    (submit "$@") || fail "$name: $(cat "$work/$name.err")"
    id=$(sed -n 's/^radsubmit: job //p' "$work/$name.err")
}

same_as_second()
{
    body "$work/$1.hdr" >"$work/same.body"
    cmp "$work/second.body" "$work/same.body" || fail "$1: another picture"
    [ "$(total "$work/$1.json" reused_values)" = \
        "$(total "$work/second.json" reused_values)" ] ||
        fail "$1: other records are reused"
}

worker_options=--nice=0 # other tests run beside this one
cluster_start 1 1
# shellcheck disable=SC2086 # views are words
{
    job first $first "$@"
    former=$id
    "$radctl" --coordinator="$sock" job "$former" >"$work/said"
    grep -Eq '^ambient cache +[0-9.]+ MB kept' "$work/said" ||
        fail "radctl job: $(cat "$work/said")"
    job alone $second "$@"
    rm -f "$work/alone.hdr"
    "$radctl" --coordinator="$sock" delete "$id" >"$work/said"
    job second $second "$@" --reuse="$former"
}
body "$work/second.hdr" >"$work/second.body"
python3 - "$work" <<'EOF' || fail "too many rays"
import json, sys
t = [json.load(open(f"{sys.argv[1]}/{n}.json"))["totals"]
     for n in ("first", "alone", "second")]
first, alone, second = (n["rays"] for n in t)
print(f"rays: {first} of the first view, {alone} of the second alone, "
      f"{second} with --reuse: {second / first:.2f}, {second / alone:.2f}")
print(f"records: {t[0]['ambient_values']}, {t[1]['ambient_values']}, "
      f"{t[2]['ambient_values']} beside {t[2]['reused_values']}")
sys.exit(second > .4 * first or t[2]["reused_values"] != t[0]["tile_values"])
EOF
# what a job began with is part of what it leaves, and of a file of its values
# shellcheck disable=SC2086 # views are words
job chain $third "$@" --reuse="$id" -af "$work/one.amb"
[ "$(total "$work/chain.json" reused_values)" -eq \
    $(($(total "$work/first.json" tile_values) +
        $(total "$work/second.json" tile_values))) ] ||
    fail "chain: $(total "$work/chain.json" reused_values) records are reused"
[ "$(records "$work/one.amb")" -eq $(($(total "$work/chain.json" reused_values) +
    $(total "$work/chain.json" tile_values))) ] ||
    fail "-af: $(records "$work/one.amb") records"
"$radctl" --coordinator="$sock" delete "$id" >"$work/said"
id=$(sed -n 's/^radsubmit: job //p' "$work/second.err")
grep -q "begins with the ambient values of job $former" "$work/second.err" ||
    fail "radsubmit does not say what it reuses: $(cat "$work/second.err")"
"$radctl" --coordinator="$sock" job "$id" >"$work/said"
grep -q "begins with that of $former" "$work/said" ||
    fail "radctl job: $(cat "$work/said")"

worker_start 2 1
worker_start 3 1
# shellcheck disable=SC2086
job again $third "$@" --reuse=last -af "$work/two.amb"
cmp "$work/one.amb" "$work/two.amb" || fail "-af: other values with three workers"
cmp "$work/chain.hdr" "$work/again.hdr" || fail "again: another picture"
"$radctl" --coordinator="$sock" delete "$id" >"$work/said"
id=$(sed -n 's/^radsubmit: job //p' "$work/second.err")
"$radctl" --coordinator="$sock" delete "$id" >"$work/said"
# shellcheck disable=SC2086
job three $second "$@" --reuse=last
same_as_second three
"$radctl" --coordinator="$sock" delete "$id" >"$work/said"

# killed while it is at it, and the former job is deleted meanwhile

coord_options=--log-level=debug
coord_crash
until_true 30 n_workers 3 || fail "the workers do not come back"
# shellcheck disable=SC2086
job between $second "$@" --reuse="$former"
same_as_second between
"$radctl" --coordinator="$sock" delete "$id" >"$work/said"
: >"$work/c.log"
# shellcheck disable=SC2086
(submit killed $second "$@" --reuse="$former") &
job=$!
until_log 'pass closed'
"$radctl" --coordinator="$sock" delete "$former" 2>"$work/said" ||
    fail "delete: $(cat "$work/said")"
job_ended || coord_crash
end_job killed
same_as_second killed
id=$(sed -n 's/^radsubmit: job //p' "$work/killed.err")

grep -q 'passes kept' "$work/c.log" ||
    echo "the job was over before its coordinator was killed"

# wrong STATUS "TEXT" OPTION...: what does not fit
wrong()
{
    want=$1 text=$2
    shift 2
    (submit wrong -x 20 -y 20 "$@")
    status=$?
    [ $status -eq "$want" ] || fail "$text: status $status"
    grep -qF -e "$text" "$work/wrong.err" || fail "$text: $(cat "$work/wrong.err")"
}

# shellcheck disable=SC2086
{
    wrong 66 "no job $former" $second "$@" --reuse="$former"
    wrong 65 "-aa differs" $second "$@" -aa .2 --reuse="$id"
    wrong 65 "--seed differs" $second "$@" --seed=7 --reuse="$id"
    wrong 0 "begins without" $second "$@" --seed=7 --reuse=last
    wrong 64 "must not be 0" $second "$@" -ab 0 --reuse=last
    room=$scenes/functions.rad
    wrong 65 "is of another scene" $second "$@" --reuse="$id"
}

# what showed another part of a scene serves, though its zones are wide here
{ cat "$scenes/room.rad"; echo 'wall ring ground 0 0 8 2 2 -9 0 0 1 0 1e4'; } \
    >"$work/site.rad"
room=$work/site.rad
set -- -vf "$scenes/room.vf" -ab 2 -ad 32 -x 40 -y 40 --surroundings=256
job there "$@" --shown 900 900 0 4
job here "$@" --reuse="$id"
[ "$(total "$work/here.json" reused_values)" = \
    "$(total "$work/there.json" tile_values)" ] ||
    fail "another part of the scene: $(cat "$work/here.err")"
expect 64 "needs a coordinator" "a cluster of its own" \
    "$radsubmit" -ab 1 --reuse=last -o "$work/wrong.hdr" "$room"
cluster_stop
"$radctl" check "$work/state" >"$work/said" 2>&1 ||
    fail "radctl check: $(cat "$work/said")"
finish
