#!/bin/sh
# cluster_preview.sh - the picture is there from the first passes over its
# pixels on: a preview shows all of it, coarse, before any row has come, and it
# is like what comes; nothing else of the job changes for that
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

raderr=$top_builddir/raderr
# sides that are no multiples of the lattices' steps
view="-vf $scenes/room.vf -x 301 -y 219 -ps 2 -pt .01 -ab 2 -aa .1 -ar 64
-ad 64 -as 16 --ambient=passes"
room=$scenes/room.rad
coord_options=--log-level=debug
cluster_start 1 1

# figure NAME LINE: of areas of 10 by 10 pixels, in percent
figure()
{
    sed "s/.* $1 *\([0-9.e+-]*\).*/\1/" "$2" | awk '{ print int(100 * $1) }'
}

# What is kept of a job that is not over.
so_far() { echo "$work"/state/jobs/*/0.preview; }

# passed STEP: the passes over the lattice of that step are closed, two but for
# the first lattice, or all is over
passed()
{
    [ "$(grep -c "pass closed .*step=$1 " c.log)" -ge $((1 + ($1 < 32))) ] ||
        gone $job
}

# look STEP NAME OPTION...: stop the worker when that pass is closed; NAME.hdr
# is what there is to be seen then, NAME.whole.hdr what comes of it
look()
{
    step=$1 name=$2
    shift 2
    for _ in 1 2 3 4 5 6 7 8; do # on a busy machine its passes may be over too soon
        : >c.log
        # shellcheck disable=SC2086 # options are words
        "$radsubmit" --coordinator="$sock" $view "$@" --preview="$name.png" \
            --stats="$name.json" -o "$name.whole.hdr" "$room" 2>"$name.err" &
        job=$!
        until_true 60 passed "$step" || fail "$name: no pass of step $step"
        # shellcheck disable=SC2154 # cluster_start sets it
        kill -STOP "$pid_1"
        grep -q 'unit out' c.log || break
        kill -CONT "$pid_1"
        wait $job
        rm -f "$name.png"
    done
    touch stopped
    until_true 20 is_new || fail "$name: no preview: $(tail -n 3 c.log)"
    cp "$(so_far)" "$name.hdr" || fail "$name: no preview to look at"
    "$radctl" --coordinator="$sock" --json jobs | grep -q '"units_done": *0' ||
        fail "$name: a unit is done before the passes are"
    until_true 20 test -s "$name.png" || fail "$name: no PNG"
    kill -CONT "$pid_1"
    wait $job || fail "$name: $(cat "$name.err")"
}

is_new() { [ -n "$(find "$(so_far)" -newer stopped)" ]; }

# alike NAME PERCENT: it is no farther off than that, and nowhere black, which
# would be off by 100 %
alike()
{
    "$raderr" -1 -b 10 "$1.hdr" "$1.whole.hdr" | tee figures
    e=$(figure nrmse figures) off=$(figure p95 figures)
    [ "${e:-1000}" -le "$2" ] || fail "$1: the preview is off by $e %"
    [ "${off:-1000}" -le 80 ] || fail "$1: a part of it is off by $off %"
}

look 8 fine
alike fine 22
look 32 coarse
alike coarse 40
# of two by two samples a pixel
look 8 double --oversample=2
alike double 10

# who does not watch has the same
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" $view --stats=blind.json -o blind.hdr \
    "$room" 2>blind.err || fail "$(cat blind.err)"
for name in fine coarse; do
    body $name.whole.hdr >seen.body
    body blind.hdr >blind.body
    cmp seen.body blind.body || fail "$name: another picture"
    # tests depend on which tile a thread made before
    for n in rays tile_rays tile_values primary_rays shadow_rays ambient_rays \
        ambient_values; do
        [ "$(total $name.json $n)" = "$(total blind.json $n)" ] ||
            fail "$name: $n is $(total $name.json $n), $(total blind.json $n)"
    done
done
cluster_finish
