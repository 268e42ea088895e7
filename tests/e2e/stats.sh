#!/bin/sh
# stats.sh - the statistics add up, and radd.stats(5) explains each name that is
# in them and no other
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

page=$top_srcdir/man/radd.stats.5
room=$scenes/room.rad
view="-vf $scenes/room.vf -x 90 -y 60 -ps 3 -ab 2 -ad 16 -as 0"

# sums FILE: rays are somebody's and of something, pixels are covered once
sums()
{
    python3 - "$1" <<'END'
import json, sys
s = json.load(open(sys.argv[1]))
t, workers, units = s["totals"], s["workers"], s["units"]
def total(list, key):
    return sum(x[key] for x in list)
def same(what, a, b):
    if a != b:
        sys.exit(f"{s['partition']}: {what}: {a} and {b}")
same("rays of workers and in all", total(workers, "rays"),
     t["rays"] + t["dropped_rays"])
same("rays of kinds", t["rays"] >= t["tile_rays"] + total(units, "rays"),
     True)
if t["estimate_rays"] == 0:
    same("rays of units and in all",
         total(units, "rays") + t["tile_rays"], t["rays"])
same("primary rays", total(units, "primary_rays"), t["primary_rays"])
same("units", total(workers, "units"), len(units))
scene = s["scene"] # which nobody has seen before
same("bytes sent", scene["sent_bytes"], scene["bundle_bytes"])
same("redone", t["units_redone"], 0)
p = s["picture"]
same("pixels", sum(u["width"] * u["height"] for u in units),
     p["width"] * p["height"] * p["frames"])
time = s["time"]
parts = time["compile_s"] + time["transfer_s"] + time["render_s"] + \
    time["write_s"]
same("parts of the time are in it", parts <= time["wall_s"] + .01, True)
END
}

# names FILE...: the keys, each once, of all objects at any depth
names()
{
    python3 - "$@" <<'END'
import json, sys
seen = set()
def walk(v):
    if isinstance(v, dict):
        seen.update(v)
    for x in v.values() if isinstance(v, dict) else v:
        if isinstance(x, (dict, list)):
            walk(x)
for path in sys.argv[1:]:
    walk(json.load(open(path)))
print("\n".join(sorted(seen)))
END
}

# every word that the page has as a name, in items and, of a dry run, in text
explained()
{
    {
        sed -n 's/^\.It Cm //p' "$page"
        sed -n '/^\.Ss A dry run/,$s/^\.Cm //p' "$page"
        sed -n 's/^\.Ss \([a-z_]*\)$/\1/p' "$page"
    } | tr -s ' ,' '\n' | grep -E '^[a-z_]+$' | sort -u
}

for share in "--partition=auto" "--partition=scanbar" "--partition=window" \
    "--partition=static --estimate=4a" "--partition=window --estimate=4b"; do
    # shellcheck disable=SC2086 # options are words
    "$radsubmit" --local --workers=3 --threads=1 $view $share -o out.hdr \
        --stats="one $share.json" "$room" 2>stderr || fail "$(cat stderr)"
    sums "one $share.json" >found 2>&1 || fail "$share: $(cat found)"
done
# shellcheck disable=SC2086
"$radsubmit" --local --workers=2 --threads=1 $view -ab 1 --error=50 \
    -o out.hdr --stats="one error.json" "$room" 2>stderr ||
    fail "$(cat stderr)"
sums "one error.json" >found 2>&1 || fail "--error: $(cat found)"
# shellcheck disable=SC2086
"$radsubmit" --local --dry-run $view --stats=dry.json "$room" >dry 2>stderr ||
    fail "dry run: $(cat stderr)"

cluster_start 1 1
# shellcheck disable=SC2086
id=$("$radsubmit" --coordinator="$sock" --detach $view --partition=window \
    --windows=100 "$room" 2>stderr) ||
    fail "$(cat stderr)"
until_true 60 "$radctl" --coordinator="$sock" fetch "$id" -o out.hdr ||
    fail "no picture"
"$radctl" --coordinator="$sock" --json job "$id" >job.json || fail "radctl job"

# a file that comes slowly, here in seven seconds, leaves time for the next question
mkfifo slow.do
"$top_builddir/tests/tools/proxy" "$work/slow" "$sock" slow.do 2>slow.log &
slow=$!
until_true 10 test -S slow || fail "no slow connection: $(cat slow.log)"
echo "rate 4000" >slow.do
"$radctl" --coordinator="$work/slow" --json job "$id" >slow.json 2>stderr ||
    fail "a slow job: $(cat stderr)"
[ "$(wc -c <slow.json)" -gt 25000 ] || fail "that is no long file"
end_one $slow "the slow connection"
cluster_stop

names one*.json dry.json job.json >said
explained >known
comm -23 said known >unknown
[ ! -s unknown ] || fail "radd.stats(5) does not explain" $(cat unknown)
comm -13 said known | grep -vxE 'auto|static|scanbar|window|cancelled' >gone
[ ! -s gone ] || fail "radd.stats(5) explains what is not there:" $(cat gone)
finish
