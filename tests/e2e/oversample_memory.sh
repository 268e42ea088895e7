#!/bin/sh
# oversample_memory.sh - neither the coordinator nor radsubmit has more of a
# picture in memory for being filtered down from a larger one
#
# OVERSAMPLE_SIDE=8000 does with such a picture what is done with a small one by
# default, and OVERSAMPLE_MIB says what may come on top; what was measured is
# printed as a table.  The coordinator keeps 4 bytes of disk for a sample.
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

side=${OVERSAMPLE_SIDE:-1000}
most=${OVERSAMPLE_MIB:-16}
python3 -c '' 2>/dev/null || {
    echo "python3 is not here"
    exit 77
}

cat >wall.rad <<'END_OF_SCENE'
void light white 0 0 3 .5 .4 .3
white polygon wall 0 0 12  -9 5 -9  9 5 -9  9 5 9  -9 5 9
void light red 0 0 3 9 .1 .1
red sphere ball 0 0 4  0 3 0 .5
END_OF_SCENE

# peak PID: most that it has had in memory [KiB]
peak()
{
    sed -n 's/^VmHWM:[[:space:]]*\([0-9]*\) kB/\1/p' "/proc/$1/status"
}

# Run a program, and print most that it had in memory [KiB].
cat >measure.py <<'END_OF_PROGRAM'
import resource, subprocess, sys
status = subprocess.call(sys.argv[1:])
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(status)
END_OF_PROGRAM

rows_bytes() # what the worker sent
{
    sed -n '/"workers"/,$s/.*"bytes_out": \([0-9]*\).*/\1/p' "$1" | head -n 1
}

# Of each a cluster of its own, so that peaks are those of the one job.
run() # N
{
    cluster_start 1 2
    python3 measure.py "$radsubmit" --coordinator="$sock" --oversample="$1" \
        -x "$side" -y "$side" -vp 0 0 0 -vd 0 1 0 -vh 60 -vv 60 -ab 0 -ps 16 \
        -pj 0 -dv- --stats="stats$1.json" -o "out$1.hdr" wall.rad \
        >client 2>err || fail "N = $1: $(cat err)"
    client=$(cat client)
    coord=$(peak "$coord_pid")
    disk=$(du -sk state | cut -f 1)
    cluster_stop
    coord_pid=
    rm -rf state run w1
    s=$(sed -n 's/^ *"render_s": \([0-9.]*\),*$/\1/p' "stats$1.json")
    w=$(sed -n 's/^ *"write_s": \([0-9.]*\),*$/\1/p' "stats$1.json")
    echo "$1 $coord $client $(rows_bytes "stats$1.json") \
$(wc -c <"out$1.hdr") $disk ${s:-0} ${w:-0}" >>table
    rm -f "out$1.hdr"
}

for n in 1 2 3; do
    run $n
done
echo "picture of $side by $side; N, MiB of radcoord, MiB of radsubmit, MB of" \
    "rows, MB of the picture, MiB on disk at the end, s to render, s to write"
awk '{ printf "%d %.1f %.1f %.2f %.2f %.1f %.1f %.1f\n",
    $1, $2 / 1024, $3 / 1024, $4 / 1e6, $5 / 1e6, $6 / 1024, $7, $8 }' table
awk -v most="$most" 'NR == 1 { coord = $2; client = $3 }
    !(NF == 8 && $2 > 1000 && $3 > 1000 && $4 > 0) { bad = 1 }
    $2 - coord > 1024 * most || $3 - client > 1024 * most { bad = 1 }
    END { exit !(bad == 0 && NR == 3) }' table ||
    fail "more than $most MiB on top of N = 1"
finish
