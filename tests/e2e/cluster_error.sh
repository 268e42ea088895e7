#!/bin/sh
# cluster_error.sh - --error and --time: the same bytes and counts by --error
# whoever makes the picture, and after a coordinator that is killed in any stage,
# or a worker; what was asked for and reached is said, and options that do not go
# with them are refused
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

view="-vf $scenes/room.vf -x 160 -y 120 -ps 2 -pt .1 -ab 2 -aa .4 -ar 16 -ad 32
-as 8"
room=$scenes/room.rad
wanted=1.5
goal=--error=$wanted

# render NAME OPTION...
render()
{
    name=$1
    shift
    # shellcheck disable=SC2086 # options are words
    "$radsubmit" --local "$@" $view --stats="$name.json" -o "$name.hdr" \
        "$room" 2>"$name.err" || fail "$name: $(cat "$name.err")"
}

# the same picture, header and all, and the same counts as the calm one
same()
{
    cmp calm.hdr "$1.hdr" || fail "$1: another picture"
    for count in tile_rays tile_values primary_rays; do
        [ "$(total "$1.json" $count)" = "$(total calm.json $count)" ] ||
            fail "$1: $count $(total "$1.json" $count)," \
                "not $(total calm.json $count)"
    done
}

# option LETTERS NAME: its value in the header
option()
{
    LC_ALL=C sed -n "/^\$/q; s/^radsubmit .* -$1 \([^ ]*\).*/\1/p" "$2.hdr"
}

# --- whoever makes it ---

render calm $goal --workers=1 --threads=1
stages=$(sed -n 's/.*; \([2-4]\) stages.*/\1/p' calm.err)
[ -n "$stages" ] || fail "not several stages: $(cat calm.err)"
grep -q "estimated error .* %, $wanted % were asked for" calm.err ||
    fail "it is not said what was reached: $(cat calm.err)"
grep -Eq '^radsubmit .* -aa 0?\.4( |$)' calm.hdr &&
    fail "the header has the first stage's options"
# with the rays of a pixel that the stages chose, as one thread alone makes it
# shellcheck disable=SC2086 # options are words
"$top_builddir/tests/tools/seqpict" --ambient=passes $goal $view -o seq.hdr \
    "$room" 2>seq.err || fail "seqpict: $(cat seq.err)"
for f in calm seq; do
    LC_ALL=C sed '1,/^$/d' $f.hdr >$f.body
done
cmp calm.body seq.body || fail "another picture than one thread's"
render three $goal --workers=3 --threads=1
same three
render threads $goal --workers=1 --threads=2
same threads
render window $goal --workers=2 --threads=1 --partition=static
same window

# --- whoever is lost ---

start()
{
    : >c.log
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" $goal $view --stats="$1.json" \
        -o "$1.hdr" "$room" 2>"$1.err" &
    job=$!
}

finish_job()
{
    end_job "$1"
    same "$1"
}

# submit NAME OPTION...; $id is its id
submit()
{
    name=$1
    shift
    # shellcheck disable=SC2086
    "$radsubmit" --coordinator="$sock" $view "$@" --stats="$name.json" \
        -o "$name.hdr" "$room" 2>"$name.err" || fail "$name: $(cat "$name.err")"
    id=$(sed -n 's/^radsubmit: job //p' "$name.err")
}

# --- what it leaves, and begins with (--reuse) ---

other="-vp 2 2.2 1.4 -vd -.3 1 -.1"
cluster_start 1 1
submit first $goal
former=$id
grep -q "^radsubmit: stage 1: error about .* now a finer one$" first.err ||
    fail "nothing is said of the first stage: $(cat first.err)"
grep -q "^radsubmit: stage $stages: error about .* now the picture$" first.err ||
    fail "nothing is said of the last stage: $(cat first.err)"
# shellcheck disable=SC2086
{
    submit one --error=5 $other --reuse=last
}
grep -q "begins with the ambient values of job $former" one.err ||
    fail "--reuse=last: $(cat one.err)"
[ "$(total one.json reused_values)" -gt 0 ] || fail "nothing is reused"
[ "$(total one.json tile_rays)" -lt "$(total first.json tile_rays)" ] ||
    fail "tiles take $(total one.json tile_rays) rays with --reuse," \
        "$(total first.json tile_rays) of the first view"
[ "$(option aa one)" = "$(option aa first)" ] ||
    fail "-aa $(option aa one) where the former job ended with" \
        "$(option aa first)"
# shellcheck disable=SC2086
{
    for name in aa ar ad as ds dj dt dc st; do
        echo "-$name $(option $name first)"
    done >words
    submit given @words $other --reuse="$former" # no goal
    submit next $goal --reuse="$id"              # from that, with one
}
worker_start 2 1
worker_start 3 1
coord_crash
until_true 30 n_workers 3 || fail "the workers do not come back"
# shellcheck disable=SC2086
submit three --error=5 $other --reuse="$former"
cmp one.hdr three.hdr || fail "--reuse: another picture with three workers"
# further stages begin empty, on any cluster
# shellcheck disable=SC2086
submit finer --error=.25 $other --reuse="$former"
grep -q '; [2-4] stages' finer.err || fail "not several stages: $(cat finer.err)"
# shellcheck disable=SC2086
submit again --error=.25 $other --reuse="$former"
cmp finer.hdr again.hdr || fail "--reuse: another picture by further stages"
cluster_stop

coord_options=--log-level=debug
cluster_start 2 1

# in the first stage, after its end, in the second one's last pass, at the end of
# all, in the picture
n=0
for at in 'pass=2 ' 'stage=0 ' 'stage=1 ' 'goes_on=0' 'unit out'; do
    n=$((n + 1))
    start "again$n"
    until_log "$at"
    job_ended || coord_crash
    finish_job "again$n"
done

start worker
until_log 'stage=0 '
id=$(sed -n 's/^radsubmit: job //p' worker.err)
"$radctl" --coordinator="$sock" job "$id" >said
grep -q "^asked for *error of $wanted %" said || job_ended ||
    fail "radctl job says nothing of what was asked for: $(cat said)"
grep -Eq '^stage *2 of at most 4, estimated error' said || job_ended ||
    fail "radctl job says nothing of stages: $(cat said)"
# shellcheck disable=SC2154 # worker_start sets them
kill -KILL "$pid_1"
wait "$pid_1" 2>/dev/null
worker_start 1 1
worker_start 3 1
finish_job worker
cluster_stop

# --- by the clock ---

times >before
render clock --time=2 --workers=2 --threads=1
times >after
grep -q 'another run may' clock.err || fail "no word of the clock"
grep -q '"by_clock": true' clock.json || fail "nothing of it in statistics"
# of two processors, however long it has to wait for them
awk -F '[ms ]+' 'FNR == 2 { s = 60 * ($1 + $3) + $2 + $4 - s }
    END { exit !(s > 0 && s < 2 * 12) }' before after ||
    fail "--time=2 took: $(cat before after)"

# too short for a second stage
render short --time=.1 --workers=1 --threads=1
grep -q '1 stage, and no time for another$' short.err ||
    fail "it is not said that time was short: $(cat short.err)"
grep -q '"time_up": true' short.json || fail "nothing of it in statistics"

# more than enough: what was asked for ends it, with the options that it would
# have without a clock
render both $goal --time=10000 --workers=2 --threads=1
cmp calm.hdr both.hdr || fail "a long --time makes another picture"
grep -q 'another run may' both.err &&
    fail "the clock has not decided: $(cat both.err)"
grep -q '"by_clock": false' both.json || fail "nothing of it in statistics"

# time is left, and no stage is worth it
cat >simple.rad <<'EOF'
void plastic grey 0 0 5 .5 .5 .5 0 0
grey sphere ball 0 0 4 0 0 0 1
void light lamp 0 0 3 20 20 20
lamp sphere bulb 0 0 4 3 3 4 .5
EOF
"$radsubmit" --local --time=10000 -vp 5 0 1 -vd -1 0 0 -x 64 -y 64 \
    -o simple.hdr simple.rad 2>err || fail "$(cat err)"
grep -q 'stages*, and there is no other that is much better$' err ||
    fail "nothing of why it ended before its time: $(cat err)"

# --- what does not go together ---

# refused WORDS OPTION...: with these words, and status 64
refused()
{
    words=$1
    shift
    "$radsubmit" --local "$@" -o no.hdr "$room" 2>err
    status=$?
    [ $status -eq 64 ] || fail "$*: status $status: $(cat err)"
    grep -q -- "$words" err || fail "$*: $(cat err)"
}

refused 'from 0.1 to 100' --error=0
refused 'from 0.1 to 100' --error=-5
refused 'from 0.1 to 100' --error=nan
refused 'from 0.1 to 100' --error=101
refused 'from 0.1 to 1' --time=0
refused '--ambient=live and --error exclude' --error=5 --ambient=live
refused '--no-share and --error exclude' --error=5 --no-share
refused '--dry-run and --time exclude' --time=5 --dry-run
refused '-af and --error exclude' --error=5 -ab 1 -af records
refused 'with indirect light' --error=5 -ab 0
refused 'with indirect light' --time=5 -aa 0 -ab 1
refused 'with indirect light' --error=5 -ps 1 # rpict's -ab is 0
i=0
while [ $i -lt 33 ]; do
    echo "VIEW= -vp 0 $i 1"
    i=$((i + 1))
done >many.vf
refused 'at most 32 frames' --error=5 -ab 1 -S 1 --views=many.vf
finish
