#!/bin/sh
# sim_windows.sh - the simulator takes windows for what a former run's took,
# gives a host as many threads as it is told, of which the coordinator hears at
# once, and lets messages come while the coordinator is at others
#
# Sixteen windows, the first of which took most of the time: two hosts need
# about as long as one.  By rows alone its neighbours would share its cost.
: "${top_builddir:=.}"
sim=$top_builddir/bench/sim/sim
tmp=$(mktemp -d) || exit 99
trap 'rm -rf "$tmp"' EXIT

# statistics FIRST-WINDOW-SECONDS
statistics()
{
    echo '{"options": "-ps 4", "units": ['
    awk -v cpu="$1" 'BEGIN {
        for (i = 0; i < 16; i++) {
            printf "%s{\"frame\": 0, \"x\": %d, \"y\": %d, \"width\": 120,", \
                i ? "," : "", i % 4 * 120, int(i / 4) * 80
            print "\"height\": 80, \"rays\": 1, \"cpu_s\": " cpu "}"
            cpu = 1
        }
    }'
    echo '], "picture": {"width": 480, "height": 320, "frames": 1}}'
}

speed_up() # FIRST-WINDOW-SECONDS
{
    statistics "$1" >"$tmp/costs.json"
    "$sim" --ways=window --windows=16 --hosts=2 "$tmp/costs.json" |
        awk '$1 == 2 && NF == 3 { print $2 }'
}

even=$(speed_up 1)
uneven=$(speed_up 85)
echo "sixteen windows on two hosts: $even times as fast, $uneven if one is dear"
awk -v even="$even" -v uneven="$uneven" 'BEGIN {
    exit !(even > 1.9 && even <= 2 && uneven >= 1.1 && uneven < 1.2) }' || exit 1

# teams of threads, each a member on a line of its own
threads=$("$sim" --ways=auto --size=480x320 --seconds=20 --threads=4 --hosts=1 |
    awk '$1 == 1 && NF == 3 { print $2 }')
echo "four threads of one host: $threads times as fast"
awk -v n="$threads" 'BEGIN { exit !(n > 3.5 && n <= 4) }' || exit 1

# the first host that is ready gets no more than its share
even=$("$sim" --ways=scanbar --size=960x640 --seconds=40 --threads=8 --hosts=4 \
    --details | awk '$1 == "scanbar" && $5 == "eff" { print $6 }')
echo "four hosts of eight threads: $even %"
awk -v even="$even" 'BEGIN { exit !(even > 88) }' || exit 1

# rows of a thousand windows: their line and the coordinator work side by side
many_windows() # OPTION...
{
    "$sim" --ways=window --windows=1000 --size=960x640 --seconds=.5 --hosts=8 \
        "$@" --details | awk '$1 == "window" && $4 == "s" { print $3 }'
}

line=$(many_windows --bandwidth=12)
both=$(many_windows --bandwidth=12 --coord=500)
echo "rows on a slow line: $line s, to a slow coordinator: $both s"
awk -v line="$line" -v both="$both" 'BEGIN {
    exit !(line > 1.5 && both >= line && both < 1.1 * line) }'
