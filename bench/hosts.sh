#!/bin/sh
# hosts.sh [options] BUILD [SCENE VIEW]... - the ways to share a picture,
# measured on emulated workstations
#
# Each workstation is a radd of one thread with a share of a processor (a
# cgroup's CPU quota, version 1 or 2) and a loopback address of its own; the
# coordinator and radsubmit have no quota.  Every run has a fresh cluster, so
# that reading, sending and loading the scene count.  The runs of one round
# follow each other, the baseline (one worker) first; tables give the medians
# of all rounds.  Processors that others use as well are not as fast in one run
# as in the next; so beside the speed-up stands what it would have been had a
# ray cost the same processor time in both runs.  Where quotas are not to be had, workers are plain processes,
# up to the processors there are.
#
#   --quota=Q        of a processor, for each workstation (0.2)
#   --rounds=N       (3)
#   --size=WxH       of the picture at most (1920x1280)
#   --workers=LIST   numbers of workstations (2,4,8)
#   --windows=LIST   numbers of windows (16,64,256)
#   --tables=LIST    of share, estimate, static, ways, windows, sim, animation
#                    (all); sim sets what is measured beside what bench/sim/sim
#                    makes of the costs, if it is built
#   --frames=N       of the animation, whose views turn around the given one's
#                    point in equal steps (12)
#   --views=FILE     its views, one a line, in place of those
#   --options=TEXT   rendering options, in place of the usual ones
#   --results=DIR    tables are written there as well (bench/results)
#   --check          only measure what the quotas give
#
# SCENE VIEW: a scene file and a view file, as often as there are scenes to
# measure; the example scene by default.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
quota=0.2 rounds=3 size=1920x1280 workers=2,4,8 windows=16,64,256
tables=share,estimate,static,ways,windows,sim,animation
frames=12 views='' results=bench/results check=
options='-ab 2 -aa .25 -ar 48 -ad 256 -as 64 -ps 4 -pt .05 -dj .5 -ds .2
-dt .05 -dc .75 -pj .9 -st .1 -lr 6 -lw .005'

die()
{
    echo "hosts.sh: $*" >&2
    exit 64
}

is_list() # of numbers from 1
{
    echo "$1" | grep -Eqx '[1-9][0-9]{0,5}(,[1-9][0-9]{0,5})*'
}

while [ $# -gt 0 ]; do
    case $1 in
    --quota=*) quota=${1#*=} ;;
    --rounds=*) rounds=${1#*=} ;;
    --size=*) size=${1#*=} ;;
    --workers=*) workers=${1#*=} ;;
    --windows=*) windows=${1#*=} ;;
    --tables=*) tables=${1#*=} ;;
    --frames=*) frames=${1#*=} ;;
    --views=*) views=${1#*=} ;;
    --options=*) options=${1#*=} ;;
    --results=*) results=${1#*=} ;;
    --check) check=yes ;;
    --) shift && break ;;
    -*) die "unknown option '$1'" ;;
    *) break ;;
    esac
    shift
done
[ $# -ge 1 ] || {
    sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2
    exit 64
}
build=$(cd "$1" && pwd)
shift
[ $(($# % 2)) -eq 0 ] || die "a scene without a view: $*"
[ $# -gt 0 ] || set -- "$here/../examples/reading-room/room.rad" \
    "$here/../examples/reading-room/room.vf"
for list in "$workers" "$windows" "$rounds" "$frames"; do
    is_list "$list" || die "'$list' is no list of numbers"
done
echo "$size" | grep -Eqx '[1-9][0-9]*x[1-9][0-9]*' || die "no size: '$size'"
awk -v q="$quota" 'BEGIN { exit !(q + 0 > 0 && q + 0 <= 1) }' ||
    die "a quota is above 0 and at most 1: '$quota'"
for t in $(echo "$tables" | tr , ' '); do
    case $t in
    share | estimate | static | ways | windows | sim | animation) ;;
    *) die "no table '$t'" ;;
    esac
done
for program in radcoord radd radsubmit radctl; do
    [ -x "$build/$program" ] || die "no $program in '$build'"
done
for file in "$@" ${views:+"$views"}; do
    [ -r "$file" ] || die "cannot read '$file'"
done
[ -z "$views" ] || frames=$(grep -c . "$views")
workers=$(echo "$workers" | tr , ' ')
windows=$(echo "$windows" | tr , ' ')
most=1
for n in $workers; do
    [ "$n" -le "$most" ] || most=$n
done
mkdir -p "$results"
results=$(cd "$results" && pwd)
[ -z "$views" ] || views=$(cd "$(dirname "$views")" && pwd)/$(basename "$views")

tmp=$(mktemp -d "${TMPDIR:-/tmp}/hosts.XXXXXX")
pids='' coord_pid=''

stop_cluster()
{
    for pid in $coord_pid $pids; do
        kill "$pid" 2>/dev/null || :
    done
    for pid in $coord_pid $pids; do
        wait "$pid" 2>/dev/null || :
    done
    pids='' coord_pid=''
}

leave()
{
    stop_cluster
    quota_end
    rm -rf "$tmp"
}
trap leave EXIT
trap 'exit 1' INT TERM HUP

# --- shares of a processor ---

# Folder of the version 1 hierarchy that has "cpu", or of version 2 if its
# groups can have it; where this process is in it.
cgroup_folder() # VERSION
{
    if [ "$1" -eq 1 ]; then
        mount=$(awk '$3 == "cgroup" && ("," $4 ",") ~ /,cpu,/ { print $2; exit }' \
            /proc/mounts)
        path=$(awk -F: '("," $2 ",") ~ /,cpu,/ { print $3; exit }' \
            /proc/self/cgroup)
    else
        mount=$(awk '$3 == "cgroup2" { print $2; exit }' /proc/mounts)
        path=$(sed -n 's/^0:://p' /proc/self/cgroup)
        grep -qw cpu "$mount$path/cgroup.controllers" 2>/dev/null || return 1
    fi
    [ -n "$mount" ] && [ -d "$mount$path" ] && echo "${mount}${path%/}"
}

# Groups of version 2 get "cpu" from the one above, which may then hold no
# processes, unless it is the root: so this one moves down.
v2_enable()
{
    echo +cpu 2>/dev/null >"$1/cgroup.subtree_control" && return 0
    mkdir "$1/radd-bench-self.$$" &&
        echo 0 >"$1/radd-bench-self.$$/cgroup.procs" &&
        echo +cpu >"$1/cgroup.subtree_control"
}

# A group for each workstation; sets $groups, the folder that they are in.
quota_begin() # VERSION
{
    folder=$(cgroup_folder "$1") || return 1
    [ "$1" -eq 1 ] || v2_enable "$folder" || return 1
    mkdir "$folder/radd-bench.$$" || return 1
    groups=$folder/radd-bench.$$
    [ "$1" -eq 1 ] || echo +cpu >"$groups/cgroup.subtree_control" || return 1
    # a period of 5 ms, longer where the quota would be below its least, 1 ms
    period=$(awk -v q="$quota" 'BEGIN {
        p = q * 5000 < 1000 ? 1000 / q : 5000; printf "%d", p + .5 }')
    us=$(awk -v q="$quota" -v p="$period" 'BEGIN { printf "%d", q * p + .5 }')
    k=1
    while [ $k -le "$most" ]; do
        mkdir "$groups/w$k" || return 1
        if [ "$1" -eq 1 ]; then
            echo "$period" >"$groups/w$k/cpu.cfs_period_us" &&
                echo "$us" >"$groups/w$k/cpu.cfs_quota_us" || return 1
        else
            echo "$us $period" >"$groups/w$k/cpu.max" || return 1
        fi
        k=$((k + 1))
    done
}

quota_end()
{
    [ -n "${groups:-}" ] || return 0
    tries=100 # what was killed may take a moment to go
    while [ -d "$groups" ] && [ $tries -gt 0 ]; do
        for g in "$groups"/w* "$groups"; do
            rmdir "$g" 2>/dev/null || :
        done
        [ ! -d "$groups" ] || sleep .05
        tries=$((tries - 1))
    done
    groups=
}

# on_host K COMMAND...: in workstation K's group
on_host()
{
    [ -z "${groups:-}" ] || echo 0 >"$groups/w$1/cgroup.procs"
    shift
    exec "$@"
}

# Loops of the shell in workstations 1 to N for two seconds: for each the
# share of a processor and the turns a second.
spin() # N
{
    i=1
    while [ $i -le "$1" ]; do
        # shellcheck disable=SC2016 # for the inner shell
        on_host $i sh -c 'n=0
            trap "echo \$n; times; exit" TERM
            while :; do n=$((n + 1)); done' >"$tmp/spin.$i" &
        pids="$pids $!"
        i=$((i + 1))
    done
    sleep 2
    stop_cluster
    awk 'function seconds(t) { split(t, a, /[ms]/); return 60 * a[1] + a[2] }
        FNR == 1 { turns += $1 }
        FNR == 2 { s = seconds($1) + seconds($2); n++; sum += s
            if (n == 1 || s < least) least = s
            if (s > greatest) greatest = s }
        END { printf "%.4f %.4f %.4f %.0f\n", sum / n / 2, least / 2,
            greatest / 2, turns / n / 2 }' "$tmp"/spin.*
    rm -f "$tmp"/spin.*
}

check_quota()
{
    alone=$(spin 1)
    all=$(spin "$most")
    echo "$alone $all" | awk -v q="$quota" -v n="$most" '{
        printf "One busy loop alone: %.3f of a processor; %d at once: %.3f" \
            " each (%.3f to %.3f),\nand each makes %.3f of the turns that" \
            " it makes alone.\n", $1, n, $5, $6, $7, $8 / $4
        if (q != "" && $6 < .9 * q)
            print "Some get less than their quota: the machine has too few" \
                " processors,\nor other work.  Trust no time below." }'
}

# --- runs ---

until_true() # SECONDS COMMAND...
{
    tries=$(($1 * 50))
    shift
    while ! "$@"; do
        tries=$((tries - 1))
        [ $tries -gt 0 ] || return 1
        sleep .02
    done
}

n_workers()
{
    [ "$("$build/radctl" --coordinator="$tmp/c.sock" --json workers 2>/dev/null |
        grep -c '"name"')" -eq "$1" ]
}

# Workstations come over TCP, each with a key.
make_key() # K
{
    [ -e "$tmp/key$1" ] ||
        (umask 077 && "$build/radctl" key add "worker:w$1" \
            --keys="$tmp/keys" >"$tmp/key$1")
}

start_cluster() # N
{
    rm -rf "$tmp/state" "$tmp"/w* "$tmp/c.ports"
    k=1
    while [ $k -le "$1" ]; do
        make_key $k || return 1
        k=$((k + 1))
    done
    "$build/radcoord" --listen=127.0.0.1:0 --keys="$tmp/keys" \
        --socket="$tmp/c.sock" \
        --state="$tmp/state" --ports-file="$tmp/c.ports" \
        2>"$tmp/c.log" </dev/null &
    coord_pid=$!
    until_true 20 test -s "$tmp/c.ports" || return 1
    tcp=$(sed -n 's/^tcp //p' "$tmp/c.ports")
    k=1
    while [ $k -le "$1" ]; do
        on_host $k "$build/radd" --coordinator="$tcp" --key="$tmp/key$k" \
            --threads=1 --nice=0 --listen="127.0.0.$((k + 1)):0" \
            --cache="$tmp/w$k" 2>"$tmp/w$k.log" </dev/null &
        pids="$pids $!"
        k=$((k + 1))
    done
    until_true 30 n_workers "$1"
}

# In the scene's folder, where its files are.
submit() # OPTIONS...
{
    # shellcheck disable=SC2086 # options are words
    (cd "$(dirname "$scene")" && timeout -k 5 3600 "$build/radsubmit" \
        --coordinator="$tmp/c.sock" --stats="$tmp/stats.json" -vf "$view" \
        -x "${size%x*}" -y "${size#*x}" $options -o "$tmp/out%d.hdr" "$@" \
        "$scene") >/dev/null 2>"$tmp/err" </dev/null
}

# What is under way, to a terminal.
say()
{
    [ ! -t 2 ] || printf '\r%-70s\r' "$1" >&2
}

# Once, of one round: what a run had to say goes into $tmp/runs, a line of
# table, row, workers and statistics (stats.awk); or its error into
# $tmp/refused.
run() # TABLE ROW WORKERS OPTIONS...
{
    table=$1 row=$2 n=$3
    shift 3
    say "round $round of $rounds: $table, $row, $n"
    rm -f "$tmp/stats.json"
    echo "the cluster does not start" >"$tmp/err"
    if start_cluster "$n" && submit "$@"; then
        awk -v head="$table $row $n" -f "$here/stats.awk" "$tmp/stats.json" \
            >>"$tmp/runs"
    else
        echo "$table, $row, $n: $(grep -v ': job ' "$tmp/err" | tail -n 1)" \
            >>"$tmp/refused"
        rm -f "$tmp/stats.json"
    fi
    stop_cluster
}

keep_stats() # NAME: of the last run, if it went well
{
    [ ! -e "$tmp/stats.json" ] || mv "$tmp/stats.json" "$1"
}

share_table()
{
    for w in $windows; do
        for n in $share_workers; do
            run share "$w" "$n" --partition=window --windows="$w"
            run alone "$w" "$n" --partition=window --windows="$w" --no-share
        done
    done
}

estimate_table()
{
    for e in 5a 5b 20a 20b; do
        run estimate $e "$most" --partition=scanbar --estimate=$e
    done
}

static_table()
{
    for n in $workers; do
        for e in uniform 5a 5b 20a 20b; do
            run static $e "$n" --partition=static --estimate=$e --no-balance
        done
        [ ! -e "$optimum" ] ||
            run static optimum "$n" --partition=static \
                --estimate="$optimum" --no-balance
    done
}

ways_table()
{
    for n in $workers; do
        run ways static "$n" --partition=static
        run ways scanbar "$n" --partition=scanbar
        run ways auto "$n" --partition=auto
    done
}

windows_table()
{
    for n in $workers; do
        for w in $windows; do
            run windows "$w" "$n" --partition=window --windows="$w"
        done
    done
}

# Its runs are those of ways and windows.
sim_table()
{
    :
}

# The time of the median run of one worker, apart from that of rendering, and
# how much more rays those of a table's row have: with each doubling of workers,
# or where a run's own costs are known, in all.
one_worker() # TABLE ROW all|growth
{
    awk -v table="$1" -v row="$2" -v how="$3" -v most="$most" '
        function median(v, n,   i, j, t) {
            for (i = 2; i <= n; i++)
                for (j = i; j > 1 && v[j] < v[j - 1]; j--) {
                    t = v[j]; v[j] = v[j - 1]; v[j - 1] = t
                }
            return v[int((n + 1) / 2)]
        }
        $1 == "base" { wall[++n] = $4; render[n] = $17; rays[n] = $6 }
        $1 == table && $2 == row && $3 == most { more[++m] = $6 }
        END {
            if (n == 0) exit
            r = median(render, n)
            load = median(wall, n) - r
            ratio = m ? median(more, m) / median(rays, n) : 1
            if (how == "all")
                r *= ratio
            else if (ratio > 1 && most > 1)
                growth = 100 * (ratio - 1) * log(2) / log(most)
            printf "--seconds=%.4f --load=%.4f --growth=%.3f", r, load, growth
        }' "$tmp/runs"
}

# What the simulator makes of it: lines of way, hosts and seconds.
simulate()
{
    [ -x "$build/bench/sim/sim" ] && [ -e "$bars" ] || return 0
    list=$(echo "$workers" | tr ' ' ,)
    # shellcheck disable=SC2046 # options are words
    "$build/bench/sim/sim" $(one_worker ways auto growth) --details \
        --ways=static,scanbar,auto --hosts="$list" "$bars" |
        awk '$4 == "s" { print "ways", $1, $2, $3 }'
    for w in $windows; do
        [ -e "$tmp/costs-$w.json" ] || continue
        # shellcheck disable=SC2046
        "$build/bench/sim/sim" $(one_worker former "$w" all) --details \
            --ways=window --windows="$w" --hosts="$list" \
            "$tmp/costs-$w.json" |
            awk -v w="$w" '$4 == "s" { print "windows", w, $2, $3 }'
    done
}

animation_table()
{
    set -- -S 1 --views="$tmp/views"
    run animation fresh 1 "$@" --fresh-frames
    run animation whole 1 "$@"
    for n in $workers; do
        run animation fresh "$n" "$@" --fresh-frames
        for p in scanbar static window auto; do
            run animation $p "$n" "$@" --partition=$p
        done
    done
}

# The view turned about its upward direction, $frames in a full turn.
turn_views()
{
    awk -v n="$frames" 'function find(word, i) {
            for (i = 1; i <= NF; i++)
                if ($i == word)
                    return i
            print "no " word " in the view file" >"/dev/stderr"
            exit 1
        }
        /-vp / {
            d = find("-vd"); u = find("-vu")
            for (k = 1; k <= 3; k++) { a[k] = $(d + k); b[k] = $(u + k) }
            len = sqrt(b[1]^2 + b[2]^2 + b[3]^2)
            for (k = 1; k <= 3; k++) b[k] /= len
            dot = a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
            for (f = 0; f < n; f++) {
                t = 2 * 3.14159265358979 * f / n
                for (k = 1; k <= 3; k++) {
                    i = k % 3 + 1; j = i % 3 + 1
                    $(d + k) = a[k] * cos(t) + dot * b[k] * (1 - cos(t)) + \
                        (b[i] * a[j] - b[j] * a[i]) * sin(t)
                }
                print
            }
            exit
        }' "$view" >"$tmp/views"
}

measure() # the scene and view that are set
{
    : >"$tmp/runs"
    : >"$tmp/refused"
    first=$tmp/first.json optimum=$tmp/optimum.json bars=$tmp/bars.json
    rm -f "$optimum" "$first" "$bars" "$tmp"/costs-*.json
    round=1
    while [ "$round" -le "$rounds" ]; do
        run base auto 1
        for t in $(echo "$tables" | tr , ' '); do
            case $t in
            static) # what lines take where regions lie as they will: a
                # second run on all workstations, by the costs of a first
                [ -e "$optimum" ] || {
                    run former uniform "$most" --partition=static --no-balance
                    keep_stats "$first"
                    run former optimum "$most" --partition=static \
                        --estimate="$first" --no-balance
                    keep_stats "$optimum"
                } ;;
            sim) # of each bar, and of each window
                [ -e "$bars" ] || {
                    run former scanbar "$most" --partition=scanbar
                    keep_stats "$bars"
                    for w in $windows; do
                        run former "$w" "$most" --partition=window \
                            --windows="$w"
                        keep_stats "$tmp/costs-$w.json"
                    done
                } ;;
            animation)
                if [ -n "$views" ]; then
                    cp "$views" "$tmp/views"
                else
                    turn_views
                fi ;;
            esac
            "${t}_table"
        done
        round=$((round + 1))
    done
    say ''
}

report()
{
    echo
    echo "$(basename "$scene"), $(basename "$view"), at most $size pixels," \
        "medians of $rounds"
    echo "radsubmit $(echo "$options" | tr '\n' ' ')"
    simulate >"$tmp/simulated"
    awk -v tables="$tables" -v workers="$workers" -v windows="$windows" \
        -v share="$share_workers" -v most="$most" -v frames="$frames" \
        -f "$here/hosts.awk" "$tmp/simulated" "$tmp/runs"
    [ ! -s "$tmp/refused" ] || {
        echo
        echo 'Runs that failed:'
        sort -u "$tmp/refused"
    }
}

head_lines()
{
    echo "$("$build/radsubmit" --version), $(date -u +%Y-%m-%d)," \
        "$(nproc) processors:" \
        "$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -n 1)"
    if [ -n "${groups:-}" ]; then
        echo "Workstations of $quota of a processor, period $period us," \
            "addresses 127.0.0.2 and on."
        check_quota
    else
        echo "No CPU quotas are to be had here: workers are processes," \
            "each with a processor, as many as there are."
    fi
}

choose_hosts()
{
    quota_begin 1 2>/dev/null || { quota_end && quota_begin 2 2>/dev/null; } || {
        quota_end
        have=$(nproc) few='' most=1
        for n in $workers; do
            [ "$n" -gt "$have" ] || few="$few $n" most=$n
        done
        workers=${few# }
        [ -n "$workers" ] || die "no quotas, and fewer processors than workers"
    }
    # the paper shows what sharing saves with 4 workstations
    share_workers=$most
    case " $workers " in *' 4 '*) share_workers=4 ;; esac
}

choose_hosts
head_lines | tee "$tmp/head"
[ -z "$check" ] || exit 0
while [ $# -gt 0 ]; do
    scene=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
    view=$(cd "$(dirname "$2")" && pwd)/$(basename "$2")
    shift 2
    measure
    name=$(basename "$scene")
    report | tee "$tmp/report"
    cat "$tmp/head" "$tmp/report" >"$results/hosts-${name%.*}.txt"
    cp "$tmp/runs" "$results/hosts-${name%.*}.runs"
    [ ! -e "$bars" ] || cp "$bars" "$results/hosts-${name%.*}.json"
done
