#!/bin/sh
# radweb_page.sh - radweb's pages in a headless Chromium: what they say is what
# radctl says, in light and dark, wide and narrow; the luminance under the pointer
# is the picture's; no name of others is taken for a script
#
# With RADWEB_SHOTS=FOLDER the pictures of the pages stay there.
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
command -v python3 >/dev/null && python3 -c 'import sys
sys.path.insert(0, sys.argv[1])
import browser
sys.exit(browser.program() is None)' "$top_srcdir/tests/web" || {
    echo "SKIP: no Chromium and python3 here (Debian: chromium)"
    exit 77
}
# a user's Chromium makes a sandbox of its own, which not every host permits
[ "$(id -u)" -eq 0 ] || PYTHONPATH=$top_srcdir/tests/web python3 -c '
import browser
browser.Browser("try").close()' 2>/dev/null || {
    echo "SKIP: Chromium does not start here: $(tail -1 try.log)"
    exit 77
}
shots=${RADWEB_SHOTS:-$work/shots}
mkdir -p "$shots"
export PYTHONDONTWRITEBYTECODE=1

make_keys
make_key observer:page page.key
coord_start
worker_start 1 2
until_true 30 n_workers 1 || fail "the worker does not come"
"$top_builddir/radweb" --coordinator="$tcp" --key="$work/page.key" \
    --listen=127.0.0.1:0 --ports-file="$work/web.ports" 2>web.log &
web=$!
wait_file web.ports
url=$(sed 's|^\([a-z]*\) |\1://|' web.ports)

submit() # NAME WIDTH OPTION...
{
    name=$1 width=$2
    shift 2
    "$radsubmit" --coordinator="$tcp" --key="$work/user.key" --name="$name" \
        -vf "$scenes/room.vf" -x "$width" -y "$width" "$@" \
        "$scenes/room.rad" 2>stderr || fail "submit: $(cat stderr)"
}
submit '<script>alert(1)</script>"><img src=x onerror=alert(2)>' 40 -o evil.hdr
submit 'reading room, north' 300 -ab 1 -o north.hdr
id=$("$radctl" --coordinator="$tcp" --key="$work/admin.key" --json jobs |
    python3 -c 'import json, sys
print([j["job"] for j in json.load(sys.stdin) if "north" in j["name"]][0])')
mkfifo go
trap '' PIPE # click.py may have failed, and read no word
python3 "$top_srcdir/tests/web/click.py" "$url" "$id" "$shots" "$radctl" \
    --coordinator="$tcp" --key="$work/admin.key" --json <go >looks &
page=$!
exec 3>go
until_true 100 grep -q look looks || fail "the pages are not looked through"
submit 'one that comes' 40 -o comes.hdr
echo go >&3
wait $page || fail "the pages"
for shot in cluster job; do
    for how in 1280-light 1280-dark 390-light 390-dark; do
        [ -s "$shots/$shot-$how.png" ] || fail "no picture of $shot-$how"
    done
done
kill "$web" "$pid_1" "$coord_pid"
wait "$web" "$pid_1" "$coord_pid"
finish
