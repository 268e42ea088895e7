# shellcheck shell=sh
# steer_lib.sh - what the tests of steering share; read with "." after
# cluster.sh
ctl()
{
    "$radctl" --coordinator="$sock" "$@"
}

# submit NAME [OPTIONS]: in the background; its process is $job, its id $id
submit()
{
    name=$1
    shift
    "$radsubmit" --coordinator="$sock" --name="$name" --stats="$name.json" \
        -vf "$scenes/room.vf" -ps 1 -dj 1 -o "$name.hdr" "$@" \
        "$scenes/room.rad" 2>"$name.err" &
    job=$!
    until_true 30 is_new "$name" || {
        fail "$name: no job: $(cat "$name.err")"
        finish
    }
    id=$(sed -n "s/.*job new job=\([0-9a-f]*\) .* name=$name\$/\1/p" c.log)
}

is_new()
{
    grep -q "job new .* name=$1\$" c.log
}
