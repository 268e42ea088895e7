#!/bin/sh
# coord_frames.sh - a job of very many frames is accepted, taken up again and
# cancelled without a file for each, while others are served
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

FRAMES=60000

yes 'rvu -vv 9' | head -n $FRAMES >views
coord_start
"$radsubmit" --coordinator="$sock" --detach -S 1 --views=views -x 8 -y 6 -ps 1 \
    -vf "$scenes/room.vf" -ab 0 "$scenes/room.rad" >id 2>stderr ||
    fail "it is not accepted: $(cat stderr)"
id=$(cat id)
[ "$(find "state/jobs/$id" -type f | wc -l)" -le 2 ] ||
    fail "$(find "state/jobs/$id" -type f | wc -l) files before anything began"
# 4 bytes a pixel; the file has another name until the database knows the job
until_true 10 test -e "state/jobs/$id/room"
[ "$(stat -c %s "state/jobs/$id/room")" -ge $((FRAMES * 8 * 4)) ] ||
    fail "no room is kept"

# frames that begin take theirs from it, another life goes on with what is left
worker_start 1 1
some_done()
{
    [ "$(find "state/jobs/$id" -name '*.hdr' | wc -l)" -ge 20 ]
}
until_true 60 some_done || fail "no frame is done: $(tail -n 3 c.log)"
"$radctl" --coordinator="$sock" status >status || fail "no answer meanwhile"
kill -KILL "$coord_pid"
wait "$coord_pid" 2>/dev/null
before=$(stat -c %s "state/jobs/$id/room")
"$radctl" check state >check || fail "check: $(cat check)"
coord_again
more_done()
{
    [ "$(stat -c %s "state/jobs/$id/room")" -lt "$before" ]
}
until_true 60 more_done || fail "it does not go on: $(tail -n 3 c.log)"
"$radctl" --coordinator="$sock" cancel "$id" 2>stderr ||
    fail "it cannot be cancelled: $(cat stderr)"
no_room()
{
    ! [ -e "state/jobs/$id/room" ]
}
until_true 30 no_room || fail "its room is not given back"
cluster_finish
