#!/bin/sh
# manpages.sh - every program that is built has a page, every option that its
# --help or -defaults prints is in that page, and the pages are well formed
set -u
: "${top_srcdir:=.}" "${top_builddir:=.}"
failed=0

fail()
{
    echo "manpages: $*"
    failed=1
}

# The options that a page's item lines name, one a line, with their dashes.
documented()
{
    sed -n 's/\\-/-/g; s/^\.It //p' "$1" | awk '{
        flag = 0
        for (i = 1; i <= NF; i++) {
            if ($i == "Fl") { flag = 1; continue }
            if (flag && $i != ",") { print "-" $i; flag = 0 }
            if ($i == ",") flag = 1
        }
    }'
}

# Words of a help text that are options: -x, -vf, --name of --name=VALUE.
offered()
{
    tr -s ' ,[]|' '\n' | sed -n 's/^\(--*[a-zA-Z0-9][-a-zA-Z0-9]*\).*/\1/p' |
        sort -u
}

# rpict's -defaults prints "-dv+", "-vtv" for -dv and -vt.
plain()
{
    sed 's/[-+]$//; s/^\(-vt\).*/\1/'
}

check_options() # PAGE TITLE < options
{
    known=$(documented "$1")
    n=0
    while read -r option; do
        n=$((n + 1))
        printf '%s\n' "$known" | grep -qxF -e "$option" ||
            fail "$2: $option is not in $(basename "$1")"
    done
    [ "$n" -gt 0 ] || fail "$2: prints no option"
}

# Each command that --help lists stands in the page's synopsis.
check_commands() # PAGE TITLE < help
{
    known=$(sed -n '/^\.Sh SYNOPSIS/,/^\.Sh DESCRIPTION/p' "$1" |
        sed -n 's/^\.Cm //p' | tr -s ' |' '\n')
    n=0
    for command in $(sed -n 's/^  \([a-z][a-z]*\) .*/\1/p'); do
        n=$((n + 1))
        printf '%s\n' "$known" | grep -qxF -e "$command" ||
            fail "$2: $command is not in the synopsis of $(basename "$1")"
    done
    [ "$n" -gt 0 ] || fail "$2: tells of no command"
}

# The table of --quality is what the words do.
check_quality() # PAGE
{
    i=0
    for word in draft low medium high reference; do
        i=$((i + 1))
        "$top_builddir/radsubmit" --quality=$word -defaults >defaults.$$
        awk -v word=$word -v column=$i '
            FNR == NR { value[$1] = $2; next }
            $1 == ".It" && $2 == "Fl" && $4 == "Ta" {
                split($0, cell, " Ta ")
                rows++
                name = "-" $3
                gsub(/\\/, "", name)
                if (value[name] + 0 != cell[column + 1] + 0)
                    print name " of " word " is " value[name] ", not " \
                        cell[column + 1]
            }
            END { if (!rows) print "no table of " word }' \
            defaults.$$ "$1" >wrong.$$
        [ ! -s wrong.$$ ] || fail "quality: $(cat wrong.$$)"
    done
}

# The page's options of the first stage of --error are those that there are.
check_first_stage() # PAGE
{
    said=$(sed -n '/^\.Ql \\-ps .*\\-lw/{s/^\.Ql //; s/ \.$//; s/\\-/-/g; p;}' \
        "$1")
    [ -n "$said" ] || fail "no options of a first stage in $(basename "$1")"
    "$top_builddir/radsubmit" --error=5 -defaults >defaults.$$
    # shellcheck disable=SC2086 # options are words
    "$top_builddir/radsubmit" --error=5 $said -defaults | cmp defaults.$$ - ||
        fail "first stage of --error: '$said' is not what there is"
}

for program in radsubmit radctl radscene raderr radcoord radd radweb; do
    path=$top_builddir/$program
    if [ ! -x "$path" ]; then
        fail "$program is not built"
        continue
    fi
    page=
    for p in "$top_srcdir/man/$program".[1-8]; do
        [ -f "$p" ] && page=$p
    done
    if [ -z "$page" ]; then
        fail "$program has no page"
        continue
    fi
    help=$("$path" --help) || fail "$program --help: exit status $?"
    "$path" --version | grep -q '[0-9]\.[0-9]' ||
        fail "$program --version: no version"
    # a line that is one word may be a path of whoever configured
    wide=$(printf '%s\n' "$help" | awk 'length > 80 && NF > 1')
    [ -z "$wide" ] || fail "$program --help is wider than a terminal: $wide"
    printf '%s\n' "$help" | offered >options.$$
    check_options "$page" "$program --help" <options.$$
    case $program in radctl | radscene)
        printf '%s\n' "$help" >help.$$
        check_commands "$page" "$program --help" <help.$$
        ;;
    esac
done

if defaults=$("$top_builddir/radsubmit" -defaults); then
    printf '%s\n' "$defaults" | awk '{ print $1 }' | sed 's/=.*//' | plain |
        sort -u >options.$$
    check_options "$top_srcdir/man/radsubmit.1" "radsubmit -defaults" \
        <options.$$
else
    fail "radsubmit -defaults: exit status $?"
fi
check_quality "$top_srcdir/man/radsubmit.1"
check_first_stage "$top_srcdir/man/radsubmit.1"
rm -f options.$$ defaults.$$ wrong.$$ help.$$

for page in "$top_srcdir"/man/*.[1-8]; do
    for section in NAME SYNOPSIS DESCRIPTION 'SEE ALSO'; do
        grep -qx ".Sh $section" "$page" ||
            fail "$(basename "$page") lacks $section"
    done
done
if command -v mandoc >/dev/null; then
    out=$(mandoc -Tlint -W warning "$top_srcdir"/man/*.[1-8] 2>&1)
    [ -z "$out" ] || fail "$out"
else
    echo "manpages: no mandoc here; the pages' form is not checked"
fi
exit $failed
