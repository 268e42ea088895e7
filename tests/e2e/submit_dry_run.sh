#!/bin/sh
# submit_dry_run.sh - --dry-run says what a job needs and will take, on a
# cluster of its own and on a real one, and renders nothing
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

view="-vf $scenes/room.vf -x 160 -y 120"
# what records rays ask for is what the trial counts
indirect="--ambient=live -ab 1 -aa .2 -ar 64 -ad 128 -as 32"
room=$scenes/room.rad

number() # NAME FILE: the first of that name
{
    sed -n "s/^ *\"$1\": \([0-9.eE+-]*\),\{0,1\}\$/\1/p" "$2" | head -n 1
}

# Within a factor of 1.5, which is what a few thousand pixels can tell.
check_close() # NAME
{
    a=$(number "$1" dry.json)
    b=$(number "$1" real.json)
    awk -v a="$a" -v b="$b" 'BEGIN {
        exit !(a > 0 && b > 0 && a < 1.5 * b && b < 1.5 * a) }' ||
        fail "$1: predicted $a, but $b"
}

for options in "-ab 0 -ps 1" "$indirect"; do
    # shellcheck disable=SC2086 # options are words
    "$radsubmit" --dry-run --stats=dry.json $view $options -o dry.hdr "$room" \
        >said 2>err || fail "--dry-run: $(cat err)"
    [ ! -s err ] || fail "--dry-run talks: $(cat err)"
    [ ! -e dry.hdr ] || fail "--dry-run makes a picture"
    for word in scene needs memory picture cluster rays time; do
        grep -q "^$word  *[^ ]" said || fail "no $word in: $(cat said)"
    done
    grep -q '^picture  159 x 120' said || fail "another picture: $(cat said)"
    # shellcheck disable=SC2086
    "$radsubmit" --local --stats=real.json $view $options -o real.hdr "$room" \
        2>err || fail "$(cat err)"
    check_close rays
    check_close primary_rays
done
check_close ambient_values
needs=$(sed -n '/"needs"/,/]/p' dry.json)
[ "$needs" = "$(sed -n '/"needs"/,/]/p' real.json)" ] || fail "other needs"

# that the job will begin with the values of a file is said once there is one
told_of_values() # how often
{
    # shellcheck disable=SC2086
    "$radsubmit" --dry-run -af values.amb $view $indirect "$room" >said 2>err ||
        fail "--dry-run with -af: $(cat err)"
    [ "$(grep -c '^reuse ' said)" -eq "$1" ] || fail "with -af: $(cat said)"
}
told_of_values 0
# shellcheck disable=SC2086
"$radsubmit" --local -af values.amb $view $indirect -o real.hdr "$room" \
    2>err || fail "-af: $(cat err)"
told_of_values 1

# a small picture is tried as a whole
small="-vf $scenes/room.vf -pa 0 -x 40 -y 40 -ab 0"
# shellcheck disable=SC2086
{
    "$radsubmit" --dry-run --stats=dry.json $small "$room" >said &&
        "$radsubmit" --local --stats=real.json $small -o real.hdr "$room" \
            2>err || fail "a small picture: $(cat err)"
}
awk -v a="$(number primary_rays dry.json)" \
    -v b="$(number primary_rays real.json)" 'BEGIN { exit a != b }' ||
    fail "of a small picture: $(grep primary_rays dry.json real.json)"

# a cache with large hemispheres, which find the sun's patch on the floor: the
# trial's is as good as the job's
cat >gap.rad <<'EOF'
void plastic wall 0 0 5 .7 .7 .7 0 0
void light sun 0 0 3 6e6 6e6 5e6
sun source s 0 0 4 .5 -.7 .6 .533
void glow sky 0 0 4 8 10 14 0
sky source d 0 0 4 0 0 1 180
wall polygon f 0 0 12 0 0 0 5 0 0 5 5 0 0 5 0
wall polygon c 0 0 12 0 0 3 0 5 3 5 5 3 5 0 3
wall polygon w 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3
wall polygon e 0 0 12 5 0 0 5 0 3 5 5 3 5 5 0
wall polygon n 0 0 12 0 5 0 5 5 0 5 5 3 0 5 3
wall polygon s 0 0 30 0 0 0 0 0 3 5 0 3 5 0 0 1.5 0 0
    1.5 0 1 3.5 0 1 3.5 0 2.2 1.5 0 2.2 1.5 0 0
EOF
look="-vp 4.7 4.7 1.6 -vd -.8 -1 -.15 -vh 75 -vv 60 -x 160 -y 160"
# shellcheck disable=SC2086
{
    "$radsubmit" --dry-run --stats=dry.json $look --quality=medium -ab 3 \
        gap.rad >said || fail "a room with a gap"
    "$radsubmit" --local --stats=real.json $look --quality=medium -ab 3 \
        -o real.hdr gap.rad 2>err || fail "$(cat err)"
}
check_close rays
awk -v a="$(number ambient dry.json)" -v b="$(number ambient real.json)" \
    'BEGIN { exit !(a > 0 && b > 0 && a < 2 * b && b < 2 * a) }' ||
    fail "the cache's error: $(grep '"ambient":' dry.json real.json)"

# what a quality promises, where all of its set holds
tiny="-vf $scenes/room.vf -x 16 -y 12"
# shellcheck disable=SC2086
{
    "$radsubmit" --dry-run --quality=low $tiny "$room" >said || fail "a quality"
    grep -qE '^quality  low, which left [0-9.]+ to [0-9.]+ % on six' said ||
        fail "no promise: $(cat said)"
    "$radsubmit" --dry-run --quality=low -aa .1 $tiny "$room" >said
    grep -q '^quality' said && fail "a promise of another set"
    "$radsubmit" --dry-run --quality=reference -ab 1 -ad 16 $tiny "$room" \
        >said 2>err
    grep -q '^quality' said && fail "a promise of what was not measured"
    [ ! -s err ] || fail "a short trial is called long: $(cat err)"

    # one that takes long says so before it begins
    "$radsubmit" --dry-run --quality=reference -ab 1 -x 4 -y 3 "$room" \
        >/dev/null 2>err
    grep -q 'may take minutes' err || fail "a long trial is silent: $(cat err)"
}

# an animation costs what its frames do
printf 'rview -vp %s 0 1\n' 0 .1 .2 >views
# shellcheck disable=SC2086
"$radsubmit" --dry-run --stats=many.json -S 1 --views=views $view -ab 0 \
    "$room" >said || fail "an animation"
grep -q ', 3 frames' said || fail "no frames: $(cat said)"
# what is said is what the statistics have, in units for people
python3 - <<'EOF' || fail "$(cat said many.json)"
import json, re
unit = {"": 1, " thousand": 1e3, " million": 1e6, " MB": 1e6,
        " s": 1, " min": 60, " h": 3600}
stats = json.load(open("many.json"))
told = stats["predicted"]
amount = r"([\d.]+)((?: thousand| million| MB| s| min| h)?)"
said = re.search(
    fr"^scene +(\d+) objects, {amount} of files$.*^memory +{amount} of.*"
    fr"^rays +{amount}, {amount} of them primary; ambient values: {amount}$.*"
    fr"^time +{amount} of one .*; about {amount}$", open("said").read(),
    re.M | re.S).groups()
assert int(said[0]) == stats["scene"]["objects"]
for at, value in enumerate([stats["scene"]["bundle_bytes"]] + [
        told[name] for name in ("memory_bytes", "rays", "primary_rays",
                                "ambient_values", "cpu_s", "wall_s")]):
    number, of = said[1 + 2 * at:3 + 2 * at]
    assert abs(float(number) * unit[of] - value) <= .06 * value, (at, value)
EOF

# a real cluster's threads; nothing is sent
sock=$work/coord.sock
"$radcoord" --listen= --socket="$sock" --state="$work/state" 2>coord.log &
coord=$!
until_true 20 "$radctl" --coordinator="$sock" status || fail "no coordinator"
"$radd" --coordinator="$sock" --name=ws1 --threads=3 --listen=127.0.0.1:0 \
    --cache="$work/cache" 2>radd.log &
worker=$!
has_worker()
{
    "$radctl" --coordinator="$sock" --json workers | grep -q ws1
}
until_true 20 has_worker || fail "no worker"
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" --dry-run $view -ab 0 "$room" >said ||
    fail "on a coordinator"
grep -q '^cluster  1 worker, 3 threads$' said || fail "cluster: $(cat said)"
[ "$("$radctl" --coordinator="$sock" --json jobs | grep -c '"job"')" -eq 0 ] ||
    fail "--dry-run made a job"

# a drained worker does not help
"$radd" --coordinator="$sock" --name=ws2 --threads=2 --listen=127.0.0.1:0 \
    --cache="$work/cache2" 2>radd2.log &
second=$!
on_two()
{
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" --dry-run --stats="$1" $view -ab 0 \
        "$room" >said || fail "on a coordinator: $1"
}
status_says() { "$radctl" --coordinator="$sock" status | grep -qE "$1"; }
until_true 20 status_says '^workers  *2, with 5 threads$' || fail "no ws2"
"$radctl" --coordinator="$sock" drain ws1 || fail "drain"
until_true 5 status_says '^workers  *1, with 2 threads \(1 drained\)$' ||
    fail "status: $("$radctl" --coordinator="$sock" status)"
on_two one.json
grep -q '^cluster  1 worker, 2 threads (1 drained)$' said ||
    fail "cluster: $(cat said)"
[ "$(number threads one.json),$(number drained one.json)" = 2,1 ] ||
    fail "one.json: $(cat one.json)"
"$radctl" --coordinator="$sock" drain ws2 || fail "drain"
until_true 5 status_says '^workers  *none \(2 drained\)$' ||
    fail "status: $("$radctl" --coordinator="$sock" status)"
on_two none.json
grep -q '^cluster  0 workers, 0 threads (2 drained)$' said ||
    fail "cluster: $(cat said)"
grep -q '; about' said && fail "a time without workers: $(cat said)"
kill "$worker" "$second" "$coord"
wait

# shellcheck disable=SC2086
expect 69 "" "no coordinator" "$radsubmit" --coordinator="$work/none.sock" \
    --wait=1 --dry-run $view "$room"
expect 64 "--dry-run" "--detach too" "$radsubmit" --dry-run --detach "$room"
printf 'void plastic p 0 0 1 .5\np sphere s 0 0 4 0 0 0 1\n' >bad.rad
expect 65 "bad.rad:1" "a bad scene" "$radsubmit" --dry-run bad.rad
check_nothing_left "--dry-run"
finish
