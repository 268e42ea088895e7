#!/bin/sh
# radctl_text.sh - what others write reaches no terminal and no log as it is:
# names that clear the screen, turn the line around or are no text at all
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

# U+009B (CSI), ESC, U+202E, U+2066, U+200B, U+2028, a lone CR, a byte of
# Latin-1; and letters that are none of that
evil=$(printf 'a\302\2332J\033[1m\342\200\256\342\201\246\342\200\213')
evil=$evil$(printf '\342\200\250\r\351 \344\272\213\303\251b')

# no_control FILE...: nothing of the kind is in them
no_control()
{
    python3 - "$@" <<'PY'
import sys, unicodedata
bad = 0
for name in sys.argv[1:]:
    with open(name, "rb") as f:
        try:
            text = f.read().decode()
        except UnicodeDecodeError as e:
            print(name, "is no UTF-8:", e)
            bad = 1
            continue
    for c in text:
        if c != "\n" and unicodedata.category(c) in ("Cc", "Cf", "Zl", "Zp"):
            print(name, "has", hex(ord(c)))
            bad = 1
sys.exit(bad)
PY
}

coord_options=--log-level=debug
cluster_start 0 0
id=$("$radsubmit" --coordinator="$sock" --detach --name="$evil" \
    -vf "$scenes/room.vf" -x 8 -y 8 "$scenes/room.rad" 2>stderr) ||
    fail "submit: $(cat stderr)"
for command in jobs "job $id" status "pause $id"; do
    # shellcheck disable=SC2086 # words
    "$radctl" --coordinator="$sock" $command >out.text 2>&1 ||
        fail "$command: $(cat out.text)"
    # shellcheck disable=SC2086
    "$radctl" --coordinator="$sock" --json $command >out.json 2>&1
    no_control out.text out.json || fail "$command shows controls"
done
"$radctl" --coordinator="$sock" jobs >out.text
grep -q 'a?2J?\[1m??????' out.text || fail "jobs: $(cat out.text)"
grep -q '事éb' out.text || fail "letters are lost: $(cat out.text)"
"$radctl" --coordinator="$sock" --json jobs | python3 -c '
import json, sys
name = json.load(sys.stdin)[0]["name"]
sys.exit(not (name.startswith("a\u009b2J\u001b[1m\u202e\u2066\u200b\u2028\r")
              and name.endswith("事éb")))' || fail "JSON loses letters"
"$radctl" --coordinator="$sock" --json status "$evil" >out.text 2>&1
"$radctl" --coordinator="$sock" drain "$evil" >>out.text 2>&1
"$radctl" --coordinator="$sock" "$evil" >>out.text 2>&1
"$radctl" check "$work/$evil" >>out.text 2>&1
"$radsubmit" --coordinator="$work/$evil" --wait=0 "$scenes/room.rad" \
    >>out.text 2>&1
"$radsubmit" "--$evil" >>out.text 2>&1
"$radsubmit" --local "$work/$evil.rad" >>out.text 2>&1
"$top_builddir/radscene" check "$work/$evil.rad" >>out.text 2>&1
"$top_builddir/radscene" "$evil" >>out.text 2>&1
"$top_builddir/raderr" "$evil" "$evil" >>out.text 2>&1
"$radcoord" --"$evil" >>out.text 2>&1
"$radd" --name="$evil" --log-level="$evil" >>out.text 2>&1
[ "$(wc -l <out.text)" -ge 12 ] || fail "where are the errors? $(cat out.text)"
no_control out.text || fail "an error shows controls: $(cat -v out.text)"
cluster_stop
no_control c.log || fail "the log has controls"
grep -q 'job new job=.* name=a?2J' c.log || fail "the log lacks the job"
finish
