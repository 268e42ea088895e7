#!/bin/sh
# submit_walk.sh - a walk of six views with indirect light: the cache stays, and
# makes the rays a third of those of fresh frames; these count what they share
# once
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

awk 'BEGIN {
    for (k = 0; k < 6; k++)
        printf "rvu -vtv -vp 2 %g 1.3 -vd %g %g -.12 -vu 0 0 1 -vh 75 -vv 60\n",
            .15 + .05 * k, sin(.03 * k), cos(.03 * k)
}' >views

walk() # OPTION: the rays; one thread, so that they are the same each time
{
    "$radsubmit" --local --threads=1 --stats=walk.json -S 1 --views=views \
        "$1" -x 80 -y 60 -ab 2 -aa .3 -ar 16 -ad 128 -as 32 \
        -o "walk$1%d.hdr" "$scenes/room.rad" 2>err || fail "$1: $(cat err)"
    sed -n 's/^ *"rays": \([0-9]*\),$/\1/p' walk.json | head -n 1
}

kept=$(walk --threads=1)
fresh=$(walk --fresh-frames)
[ "$((3 * kept))" -lt "$fresh" ] || fail "$kept rays, and $fresh with fresh frames"
for k in 1 6; do
    [ -s "walk--threads=1$k.hdr" ] || fail "no frame $k"
done

# of STAT: of the job's totals
of()
{
    sed -n '/"totals"/,/}/s/.*"'"$1"'": *\([0-9]*\).*/\1/p' pair.json
}

# each record goes to the one other worker, and all that there were when it came
# once more
"$radsubmit" --local --workers=2 --threads=1 --fresh-frames --stats=pair.json \
    -S 1 --views=views -x 240 -y 180 -ab 2 -aa .3 -ar 16 -ad 64 -as 16 \
    -o "pair%d.hdr" "$scenes/room.rad" 2>err || fail "two workers: $(cat err)"
[ "$(of ambient_sent)" -le "$((2 * $(of ambient_values)))" ] ||
    fail "$(of ambient_values) records, and $(of ambient_sent) sent"
finish
