#!/bin/sh
# identity_faults.sh - real daemons make one thread's picture with its primary
# rays, whatever becomes of them: some are killed, or lose their children, some
# stand still for moments, some leave and some join
#
# What is tried is drawn from a seed, which is printed; IDENTITY_SEED=n tries the
# same again, as far as the moments of the accidents go, IDENTITY_RUNS=n as many.
. "${top_srcdir:-.}/tests/e2e/cluster.sh"
. "$top_srcdir/tests/e2e/chance.sh"

runs=${IDENTITY_RUNS:-20}
draw_from "${IDENTITY_SEED:-}"
shared=$top_srcdir/../shared/scenes

# of_stats KEY: a number of the statistics' totals
of_stats()
{
    sed -n '/"totals"/,/}/s/.*"'"$1"'": *\([0-9]*\).*/\1/p' stats.json
}

# --- what is rendered ---

# choose_scene: $folder, $files, $where
choose_scene()
{
    list="room lit:lamps lit:tables lit:brdf lit:aniso reading reading"
    [ -d "$shared" ] && list="$list cornell night night day spots dielectric"
    # shellcheck disable=SC2086 # words
    one_of $list
    case $word in
    room) folder=$scenes files=room.rad where="-vf room.vf" ;;
    lit:*)
        folder=$scenes files="brdf_room.rad ${word#lit:}.rad"
        where="-vp 0 -2.7 1.6 -vd 0 1 -.15 -vu 0 0 1 -vh 80 -vv 60"
        ;;
    reading)
        folder=$top_srcdir/examples/reading-room files=room.rad
        where="-vf room.vf"
        ;;
    cornell) folder=$shared/cornell files=cornell.rad where="-vf box.vf" ;;
    night) folder=$shared/office files=night.rad where="-vf norm.vf" ;;
    day) folder=$shared/office files=day.rad where="-vf close.vf" ;;
    spots) folder=$shared/mist files=spots.rad where="-vf def.vf" ;;
    dielectric)
        folder=$shared/dielectric files=dielectric.rad where="-vf inside.vf"
        ;;
    esac
}

# reference OUT OPTION...: by one thread alone; its primary rays in $primary
reference()
{
    out=$1
    shift
    # shellcheck disable=SC2086
    (cd "$folder" && "$top_builddir/tests/tools/seqpict" "$@" --counts \
        -o "$work/$out" $files) 2>counts || fail "$say: $(cat counts)"
    primary=$(sed -n 's/^primary_rays //p' counts)
}

# Start it in the background: $job.  The arguments are options.
submit()
{
    # shellcheck disable=SC2086
    (cd "$folder" && exec timeout -k 5 600 "$radsubmit" --coordinator="$sock" \
        "$@" --stats="$work/stats.json" $files) 2>stderr &
    job=$!
}

same()
{
    body "$1" >a.body
    body "$2" >b.body
    cmp -s a.body b.body || fail "$say: $2 is another picture"
}

# --- who renders it, and what happens to them ---

set_drain()
{
    "$radctl" --coordinator="$sock" "$1" "w$2" >/dev/null || fail "$1 w$2"
}

# Only so many workers get units.
use_workers()
{
    k=1
    while [ $k -le 8 ]; do
        if [ $k -le "$1" ]; then
            [ "$used" -lt $k ] && set_drain undrain $k
        else
            [ "$used" -ge $k ] && set_drain drain $k
        fi
        k=$((k + 1))
    done
    used=$1
}

wait_a_moment()
{
    any 8
    sleep "0$(((any + 2) * 4))e-2"
}

# One of the workers in use, in $k and its process in $pid.
any_worker()
{
    any "$used"
    k=$((any + 1))
    eval "pid=\$pid_$k"
}

# A worker stands still half of the time, until the job is over.
slow_down()
{
    any_worker
    while ! job_ended; do
        kill -STOP "$pid"
        child_of $k | xargs -r kill -STOP 2>/dev/null
        sleep .15
        kill -CONT "$pid"
        child_of $k | xargs -r kill -CONT 2>/dev/null
        sleep .15
    done
}

disturb()
{
    case $1 in
    kill)
        wait_a_moment
        any_worker
        kill -KILL "$pid"
        wait "$pid" 2>/dev/null
        wait_a_moment
        worker_start $k "$threads"
        ;;
    child)
        wait_a_moment
        any_worker
        child_of $k | xargs -r kill -KILL 2>/dev/null
        ;;
    slow) slow_down ;;
    leave)
        wait_a_moment
        use_workers $(((used + 1) / 2))
        ;;
    join)
        wait_a_moment
        [ "$used" -lt 8 ] && use_workers $((used + 1))
        ;;
    esac
}

# --- the runs ---

threads=1
cluster_start 8 1
used=8
all=0
spare=0
redone=0
run=0
while [ "$run" -lt "$runs" ]; do
    run=$((run + 1))
    choose_scene
    one_of "-ps 4 -pt .05" "-ps 4 -pt .05" "-ps 8"
    sampling=$word
    one_of "-pj 0 -dj 0" "-pj .67 -dj .5"
    jitter=$word
    any 80
    size="-x $((220 + any)) -y $((160 + any))"
    one_of 1 1 2 3
    if [ "$word" != 1 ]; then # as many samples
        size="--oversample=$word -x $(((220 + any) / word)) -y $(((160 + any) / word))"
        one_of "" "" --clamp=4
        size="$size $word"
    fi
    one_of scanbar static auto
    share="--partition=$word"
    estimate=
    if [ "$word" = static ]; then
        one_of uniform 5a 5b 20a 20b former
        estimate=$word
        any 2
        [ "$any" = 0 ] && share="$share --no-balance"
    fi
    any 5
    frames= && [ "$any" = 0 ] && frames=yes && one_of "" --fresh-frames &&
        share="$share $word"
    one_of 2 3 5 8
    number=$word
    one_of none none kill kill child slow slow leave join
    accident=$word
    bounces="-ab 0"
    one_of "" 1 2 3
    if [ -n "$word" ] && [ -z "$frames" ]; then # seqpict has one frame
        bounces="-ab $word -aa .3 -ar 24 -ad 48 -as 16 --ambient=passes"
    fi
    options="$where $size $bounces $sampling $jitter"
    say="run $run: $options $share${estimate:+ --estimate=$estimate}\
${frames:+ 3 frames} on $number, $accident: $folder/$files"
    use_workers "$number"

    made=out.hdr
    if [ "$frames" ]; then
        want=0
        made=out%d.hdr
        : >views
        for f in 1 2 3; do
            more="-vs 0.$((f * 7)) -vl -.0$f"
            echo "VIEW= $more" >>views
            # shellcheck disable=SC2086 # options are words
            reference "ref$f.hdr" $options $more --frame=$f
            want=$((want + primary))
        done
        options="$options -S 1 --views=$work/views"
    else
        # shellcheck disable=SC2086
        reference ref.hdr $options
        want=$primary
    fi
    # shellcheck disable=SC2086
    if [ "$estimate" = former ]; then
        submit $options --partition=static -o "$work/$made"
        wait "$job" || fail "$say: $(cat stderr)"
        mv stats.json former.json
        estimate=$work/former.json
    fi
    [ "$estimate" ] && share="$share --estimate=$estimate"
    # shellcheck disable=SC2086
    submit $options $share -o "$work/$made"
    disturb "$accident"
    if ! wait "$job"; then
        fail "$say: $(cat stderr)"
        break
    fi
    if [ "$frames" ]; then
        for f in 1 2 3; do
            same "ref$f.hdr" "out$f.hdr"
        done
    else
        same ref.hdr out.hdr
    fi
    [ "$(of_stats primary_rays)" = "$want" ] ||
        fail "$say: $(of_stats primary_rays) primary rays, not $want"
    all=$((all + want))
    spare=$((spare + $(of_stats speculative_rays)))
    redone=$((redone + $(of_stats units_redone)))
    until_true 30 n_workers 8 || fail "$say: a worker does not come back"
    [ "$failed" = 0 ] || break
done
echo "$all primary rays, $spare for nothing, $redone units done again"
[ "$((spare * 50))" -lt "$all" ] ||
    fail "$spare rays for nothing, of $all"
cluster_finish
