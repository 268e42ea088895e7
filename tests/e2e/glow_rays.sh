#!/bin/sh
# glow_rays.sh - as many primary rays as rpict traces
#
# In a scene of glows alone every ray is primary, so what rpict -t 1 says at its
# end is how many pixels its sampler asks for.  The numbers are those of rpict
# 6.1; without jitter the two look at the same points.  Where rpict and oconv are
# on PATH they are asked again.
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

view="-vp 0 -10 0 -vd 0 1 0 -vh 50 -vv 38 -x 512 -y 384 -pa 0 -pj 0 -ab 0"
RAYPATH=$scenes:${RAYPATH:-}
export RAYPATH

ask_rpict() # OPTIONS
{
    # shellcheck disable=SC2086 # options are words
    rpict -t 1 $view $1 glows.oct 2>&1 >/dev/null |
        sed -n 's/^rpict: \([0-9]*\) rays.*/\1/p' | tail -n 1
}

check() # RAYS OPTIONS
{
    # shellcheck disable=SC2086
    "$radsubmit" --local --stats=stats.json $view $2 -o p.hdr \
        "$scenes/glows.rad" 2>err || fail "$2: $(cat err)"
    [ "$(total stats.json rays)" = "$(total stats.json primary_rays)" ] ||
        fail "$2: $(total stats.json rays) rays," \
            "$(total stats.json primary_rays) of them primary"
    awk -v a="$(total stats.json primary_rays)" -v b="$1" \
        'BEGIN { exit !(b > 0 && a > .999 * b && a < 1.001 * b) }' ||
        fail "$2: $(total stats.json primary_rays) primary rays," \
            "rpict has $1"
    [ ! -e glows.oct ] || [ "$(ask_rpict "$2")" = "$1" ] ||
        echo "$2: this rpict has $(ask_rpict "$2") rays, not $1"
}

if command -v rpict >/dev/null && command -v oconv >/dev/null; then
    oconv "$scenes/glows.rad" >glows.oct 2>/dev/null || rm -f glows.oct
fi
check 96439 "-ps 4 -pt .05"
check 25191 "-ps 4 -pt .15"
check 96233 "-ps 8 -pt .05"
check 24433 "-ps 8 -pt .15"
finish
