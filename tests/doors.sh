#!/bin/sh
# doors.sh - the floor plan holds: rooms use what the table says, files of
# daemons and clients never call each other in a loop, names say where they are,
# and files that are named are there
#
# The table of rooms in doc/architecture.md is the plan, from the ground up: a
# room uses only rooms that its row names, and these stand above its row.  What
# is held against the plan is #include, in all sources, and calls, by the symbols
# of the object files; so a function that is handed over by its address is no
# call of the file that calls it.
set -u
top=${top_srcdir:-$(cd "$(dirname "$0")/.." && pwd)}
build=${top_builddir:-$PWD}
tmp=$(mktemp -d "${TMPDIR:-/tmp}/doors.XXXXXX") || exit 99
trap 'rm -rf "$tmp"' EXIT

# what is wrong: a heading, then lines of standard input; noted in a file, for
# the end of a pipe runs in a shell of its own
tell()
{
    sed 's/^/    /' >"$tmp/wrong"
    [ -s "$tmp/wrong" ] || return 0
    echo "$1:"
    cat "$tmp/wrong"
    : >"$tmp/bad"
}

# --- the plan: "room user-room ..." ---
sed -n '/^| room |/,/^$/ s/^| `\([a-z/]*\)` | [^|]* | \([^|]*\) |$/\1 \2/p' \
    "$top/doc/architecture.md" | tr -d '`,-' >"$tmp/plan"
[ "$(wc -l <"$tmp/plan")" -gt 20 ] || {
    echo "no table of rooms in doc/architecture.md"
    exit 1
}
awk '{ for (i = 2; i <= NF; i++) if (!($i in seen)) print $1 " uses " $i
       seen[$1] = 1 }' "$tmp/plan" |
    tell "rooms that use one that does not stand above them in the table"

# --- includes ---
cd "$top" || exit 99
find src proto net daemon client -name '*.[ch]' -o -name '*.def' -o \
    -name '*.inc' | sort >"$tmp/files"
sed 's|/[^/]*$||' "$tmp/files" | sort -u |
    awk 'NR == FNR { is[$1] = 1; next } !($1 in is)' "$tmp/plan" - |
    tell "folders that are not in the table"
# a header is named from the tree's top or from the top of src, daemon, client
xargs grep -n '^#[[:space:]]*include[[:space:]]*"' <"$tmp/files" |
    sed 's/^\([^:]*\):\([0-9]*\):[^"]*"\([^"]*\)".*/\1 \2 \3/' |
    awk -v bad="$tmp/unknown" -v used="$tmp/used" '
        FILENAME ~ /plan$/ { room[$1] = " " $0 " "; next }
        FILENAME ~ /files$/ { is[$1] = 1; next }
        $3 == "config.h" || $3 == "tests/tools/hook.h" { next }
        {
            at = ""
            n = split("src/,daemon/,client/,", root, ",")
            for (i = 1; i <= n && at == ""; i++)
                if ((root[i] $3) in is)
                    at = root[i] $3
            if (at == "") {
                print $1 ":" $2 ": no header " $3 >bad
                next
            }
            from = $1; sub("/[^/]*$", "", from)
            to = at; sub("/[^/]*$", "", to)
            if (from == to)
                next
            print from, to >used
            if (index(room[from], " " to " ") == 0)
                print $1 ":" $2 ": " at
        }' "$tmp/plan" "$tmp/files" - >"$tmp/closed"
tell "includes that the table does not allow" <"$tmp/closed"
[ -f "$tmp/unknown" ] &&
    tell "headers that are not named by room" <"$tmp/unknown"
sort -u "$tmp/used" | awk '
    FILENAME ~ /used/ || FILENAME == "-" { used[$1 " " $2] = 1; next }
    { for (i = 2; i <= NF; i++) if (!(($1 " " $i) in used)) print $1, $i }' \
    - "$tmp/plan" | tell "doors of the table that nobody uses"

# --- files that texts and comments name, by their whole path ---
{
    find README.md CONTRIBUTING.md doc tests -name '*.md' -o -name '*.[ch]'
    cat "$tmp/files"
} | xargs grep -HnoE \
    '[^</a-z](src|proto|net|daemon|client|tests)/[a-z_0-9/]+\.(c|h|def|sh)\>' |
    awk -F: -v listed="$tmp/files" '
        BEGIN { while ((getline name <listed) > 0) gone[name] = 0 }
        { name = $NF; sub("^[^a-z]", "", name)
          if (!(name in gone)) gone[name] = system("[ -f " name " ]")
          if (gone[name]) print $1 ":" $2 ": " name }' |
    tell "files that are named and not there"

# --- README.md is installed beside what it links to ---
grep -oE '\]\(doc/[^)]*' README.md | sed 's/.*(//' | sort -u |
    while read -r name; do
        sed -n '/^dist_pages_DATA/,/[^\\]$/p' doc/local.mk |
            grep -q "^[[:blank:]]$name\( \|\$\)" || echo "$name"
    done | tell "pages and pictures of README.md that are not installed"

# --- sizes ---
grep '\.h$' "$tmp/files" | xargs wc -l |
    awk '$2 != "total" && $1 > 200 { print $2 ": " $1 " lines" }' |
    tell "headers of more than 200 lines"
xargs wc -l <"$tmp/files" | awk '$2 != "total" {
        sub("/[^/]*$", "", $2); lines[$2] += $1; files[$2]++ }
    END { for (r in lines) if (lines[r] > 4500 || files[r] > 30)
              print r ": " files[r] " files, " lines[r] " lines" }' | sort |
    tell "rooms that are too large (30 files, 4500 lines)"

# --- calls, by the objects that this build has ---
cd "$build" || exit 99
if ! command -v nm >/dev/null || ! command -v tsort >/dev/null; then
    echo "no nm or no tsort: calls were not looked at"
    [ -e "$tmp/bad" ] && exit 1
    exit 77
fi
# "file symbol type ..." of objects; one may have outlived its source
symbols()
{
    xargs nm -P -A | sed 's|/[a-z]*\(_a\)*-\([^/]*\)\.o: |/\2 |' |
        awk 'NR == FNR { is[$1] = 1; next } ($1 ".c") in is' "$tmp/files" -
}
find daemon net client -name 'lib*_a-*.o' -o -name 'rad*-*.o' |
    symbols >"$tmp/symbols"
[ -s "$tmp/symbols" ] || { echo "no objects in $build"; exit 1; }
awk '$3 ~ /^[TDBRVC]$/ { print $1, $2 }' "$tmp/symbols" | sort -u >"$tmp/has"
awk '$3 == "U" { print $1, $2 }' "$tmp/symbols" | sort -u >"$tmp/wants"
awk 'NR == FNR { where[$2] = $1; next }
     ($2 in where) && where[$2] != $1 { print $1, where[$2] }' \
    "$tmp/has" "$tmp/wants" | sort -u >"$tmp/calls"
tsort <"$tmp/calls" 2>&1 >/dev/null | sed 's/^tsort: *//' |
    tell "files that call each other in a loop (the files of one, then the next)"

# --- libm: what IEEE 754 leaves open comes from src/arith, with the same bits
# everywhere; these call libm's, for the reason beside them ---
cat >"$tmp/free" <<'END'
src/arith/elementary     what is not finite, sines beyond its range
src/scene/calc/calclib   erf() and erfc() of function files
src/passes/passcost      how far a job is, for who waits
src/image/srgb           a picture's bytes for a screen, made by one machine
src/image/metric         how far two pictures differ, said by one machine
src/tone/eye             tone curves, drawn by one machine
src/tone/falsecolour
src/tone/human
src/tone/tone
END
inexact='a?(sin|cos|tan)(h|pi)?|atan2(pi)?|sincos(pi)?|exp(2|10|m1|2m1|10m1)?'
inexact="$inexact|log(2|10|1p|2p1|10p1)?|pow(10|n|r)?|compoundn|rootn|rsqrt|cbrt"
inexact="$inexact|hypot|erfc?|[lt]?gamma|[jy][01n]"
find src -name 'lib*_a-*.o' | symbols >"$tmp/drawing"
[ -s "$tmp/drawing" ] || { echo "no objects of src in $build"; exit 1; }
awk '$3 == "U" { sub("@.*", "", $2); print $1, $2 }' "$tmp/drawing" |
    grep -E " (__)?($inexact)(_r)?([fl]|f[0-9]+x?)?(_finite)?\$" |
    sort -u >"$tmp/libm"
awk 'NR == FNR { free[$1] = 1; next }
     !($1 in free) { print $1 ".c: " $2 "()" }' "$tmp/free" "$tmp/libm" |
    tell "functions of libm that round as the machine likes (arith/elementary.h has ours)"
awk 'FILENAME ~ /libm$/ { calls[$1] = 1; next }
     !($1 in calls) { print $1 ".c" }' "$tmp/libm" "$tmp/free" |
    tell "files that may call libm and do not"

# --- names: a function begins with its file's or its room's name ---
awk '$3 == "T" && $2 != "main" { print $1, $2 }' "$tmp/symbols" | sort -u |
    awk '{
        n = split($1, part, "/")
        file = part[n]; room = part[n - 1]
        # of strict/strict_out.c: strict_, out_
        m = split(file "_" room, word, "_")
        at_home = index($2, file) == 1
        for (i = 1; i <= m; i++)
            at_home = at_home || index($2, word[i] "_") == 1
        if (!at_home)
            print $1 ": " $2 }' |
    tell "functions whose name says neither file nor room"

[ ! -e "$tmp/bad" ]
