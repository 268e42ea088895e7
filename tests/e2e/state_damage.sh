#!/bin/sh
# state_damage.sh - what radctl check, the start of radcoord and radctl fetch say
# of each damage of a state folder, by the table in doc/operations.md
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

table=$top_srcdir/doc/operations.md
view="-vf $scenes/room.vf -x 40 -y 30 -ps 1 -ds .1 -dj 1 -ab 0
--partition=scanbar"

# Nobody denies root anything: then it is another user who asks.
as=
if [ "$(id -u)" -eq 0 ]; then
    as="setpriv --reuid=65534 --regid=65534 --clear-groups"
    chmod 755 "$work"
    $as "$radctl" --version >/dev/null 2>&1 || as=none
fi
mkdir run logs
[ "$(id -u)" -ne 0 ] || chmod 777 run logs

# --- a folder with two jobs that are over and another that is under way ---

cluster_start_looping 7-13
cp -r state begun # its database knows of no job
# shellcheck disable=SC2086 # options are words
"$radsubmit" --coordinator="$sock" $view -o first.hdr -z first.z \
    "$scenes/room.rad" 2>stderr || fail "first: $(cat stderr)"
done_id=$("$radctl" --coordinator="$sock" --json jobs | python3 -c '
import json, sys
print(json.load(sys.stdin)[0]["job"])')
over_file=$(ls -S state/files | head -n 1)
ls state/files >files
printf 'rvu -vtv -vp %d .2 1.3\n' 1 2 >views
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$sock" $view --views=views -S 1 -o walk%d.hdr \
    "$scenes/room.rad" 2>stderr || fail "walk: $(cat stderr)"
views_file=$(cd state/files && grep -l -e '-vp 1 ' -- * | grep -vxFf "$work/files")
# shellcheck disable=SC2086
half_id=$("$radsubmit" --coordinator="$sock" --name=half --detach $view \
    loop.rad 2>stderr) || fail "half: $(cat stderr)"
until_true 60 in_the_middle half || fail "the job does not start"
kill -KILL "$coord_pid"
wait "$coord_pid" 2>/dev/null
kill -KILL "$pid_1"
wait "$pid_1" 2>/dev/null
half_file=$(ls -S state/files | while read -r f; do
    [ "$f" = "$over_file" ] || { echo "$f" && break; }
done)
cp -r state killed # all that is new is in the database's log
coord_start
end_one "$coord_pid" coordinator
cp -r state sound

# --- doing damage ---

flip() # FILE OFFSET: other bytes, of the same number
{
    printf 'other bytes' | dd of="$1" bs=1 seek="$2" conv=notrunc 2>dd.err ||
        fail "$(cat dd.err)"
}

path_of() # WHAT, as the table calls it
{
    case $1 in
    jobs/ID/N.rows) echo "jobs/$half_id/0.rows" ;;
    jobs/ID/N.hdr) echo "jobs/$done_id/0.hdr" ;;
    jobs/ID/N.z) echo "jobs/$done_id/0.z" ;;
    jobs/ID/stats) echo "jobs/$done_id/stats" ;;
    jobs/ID) echo "jobs/$done_id" ;;
    "files/HASH, of a job under way") echo "files/$half_file" ;;
    "files/HASH, of jobs that are over") echo "files/$over_file" ;;
    "files/HASH, the views of an animation") echo "files/$views_file" ;;
    "the folder") echo . ;;
    *) echo "$1" ;;
    esac
}

# damage FILE WHAT HOW: false where this user cannot do it
damage()
{
    case $3 in
    missing) rm -r "$1" ;;
    empty) truncate -s 0 "$1" ;;
    cut) truncate -s 10 "$1" ;;
    flipped)
        case $2 in
        radcoord.db) flip "$1" 0 ;;
        radcoord.db-wal) flip "$1" 8 ;; # the salt of all that follows
        *.rows) flip "$1" 0 ;;
        *) flip "$1" 5 ;;
        esac
        ;;
    unreadable) [ "$as" != none ] && chmod 0 "$1" ;;
    older)
        case $2 in
        radcoord.db)
            rm -f state/radcoord.db*
            cp begun/radcoord.db* state
            ;;
        *.rows) # of before anything was rendered
            size=$(stat -c %s "$1")
            truncate -s 0 "$1" && truncate -s "$size" "$1"
            ;;
        *) # of before it was whole
            truncate -s -1 "$1" ;;
        esac
        ;;
    "a pipe") # which nobody is to wait for
        rm "$1"
        mkfifo "$1"
        ;;
    "a folder")
        rm "$1"
        mkdir "$1"
        ;;
    writable) chmod 777 "$1" ;;
    "another user's")
        [ "$(id -u)" -eq 0 ] && chown 12345 "$1" && chmod 755 "$1"
        ;;
    *) fail "the table has a damage that nobody can do: $3" ;;
    esac
}

# --- what is said of it ---

status_of() # CELL
{
    echo "${1%% *}"
}

words_of() # CELL
{
    echo "$1" | sed -n 's/^[^`]*`\(.*\)`$/\1/p'
}

# said NAME CELL STATUS FILE...: is that what the cell says?
said()
{
    name=$1 cell=$2 got=$3
    shift 3
    [ "$got" -eq "$(status_of "$cell")" ] ||
        fail "$name: status $got, expected $cell: $(cat "$@")"
    cat "$@" | grep -qF -e "$(words_of "$cell")" ||
        fail "$name: not in the words of $cell: $(cat "$@")"
}

# shellcheck disable=SC2086 # options are words
start() # with what "asks" is; its words are in start.err
{
    rm -f run/ports
    $asks "$radcoord" --listen= --socket="$work/run/c.sock" \
        --state="$work/state" --ports-file="$work/run/ports" 2>start.err &
    started=$!
    until_true 30 ended_or_listens || fail "start: neither starts nor ends"
    if gone "$started"; then
        wait "$started"
        return $?
    fi
}

ended_or_listens()
{
    gone "$started" || [ -s run/ports ]
}

stop()
{
    kill -TERM "$started" 2>/dev/null
    wait "$started" 2>/dev/null
    rm -f run/ports
}

fresh()
{
    [ ! -e state ] || chmod -R u+rwX state
    rm -rf state
    case $1 in
    *-wal) cp -rp killed state ;;
    *) cp -rp sound state ;;
    esac
    chmod 700 state
    [ -z "$asks" ] || chown -R 65534:65534 state
}

# Is the folder as it was?  What is unreadable can be neither copied nor told.
same()
{
    [ ! -e before ] || diff -r before state >diff.out 2>&1
}

check_row() # WHAT HOW CHECK START
{
    asks=
    [ "$2" != unreadable ] || asks=$as
    fresh "$1"
    damage "state/$(path_of "$1")" "$1" "$2" || {
        skipped=$((skipped + 1))
        return
    }
    rm -rf before
    case $2 in
    unreadable | "a pipe") ;;
    *) cp -rp state before ;;
    esac
    $asks "$radctl" check "$work/state" >checked 2>checked.err
    said "check: $1 $2" "$3" $? checked checked.err
    same || fail "check: $1 $2: it changes something: $(cat diff.out)"
    start
    said "start: $1 $2" "$4" $? start.err
    stop
    [ "$(status_of "$4")" -eq 0 ] || {
        # which are made, empty
        rmdir state/jobs state/files 2>/dev/null
        rmdir before/jobs before/files 2>/dev/null
        same || fail "start: $1 $2: it changes something: $(cat diff.out)"
    }
    rows=$((rows + 1))
}

fetch_row() # WHAT HOW FETCH: of a coordinator that runs
{
    at=state/$(path_of "$1")
    cp -rp "$at" kept
    damage "$at" "$1" "$2" || {
        rm -r kept
        return
    }
    rm -f fetched.hdr
    case $1 in
    jobs/ID/stats)
        "$radctl" --coordinator="$work/run/c.sock" --json job "$done_id" \
            >fetched.out 2>fetched.err
        ;;
    *)
        "$radctl" --coordinator="$work/run/c.sock" fetch "$done_id" \
            -o fetched.hdr >fetched.out 2>fetched.err
        ;;
    esac
    said "fetch: $1 $2" "$3" $? fetched.err
    [ ! -e fetched.hdr ] || fail "fetch: $1 $2: it writes a picture"
    [ ! -s fetched.out ] || fail "fetch: $1 $2: it prints $(cat fetched.out)"
    [ ! -e "$at" ] || { chmod -R u+rwX "$at" && rm -r "$at"; }
    mv kept "$at"
    fetches=$((fetches + 1))
}

rows=0 fetches=0 skipped=0
sed -n '/^## A damaged state folder/,/^## What the log/p' "$table" |
    grep '^| .* | .* | [067]' | sed 's/^| //; s/ |$//' >table
while IFS='|' read -r what how check start fetch; do
    # a cell's own blanks, and the quotes of a file's name
    set -- "$(echo "$what" | sed 's/`//g; s/ *$//')" \
        "$(echo "$how" | sed 's/^ *//; s/ *$//')" \
        "$(echo "$check" | sed 's/^ *//; s/ *$//')" \
        "$(echo "$start" | sed 's/^ *//; s/ *$//')"
    check_row "$@"
done <table

asks=$as
[ "$as" != none ] || asks=
fresh all
start || fail "a sound folder does not start: $(cat start.err)"
"$radctl" --coordinator="$work/run/c.sock" fetch "$done_id" -o fetched.hdr ||
    fail "a sound picture cannot be fetched"
cmp first.hdr fetched.hdr || fail "it differs"
while IFS='|' read -r what how check start fetch; do
    fetch=$(echo "$fetch" | sed 's/^ *//; s/ *$//')
    [ -n "$fetch" ] || continue
    fetch_row "$(echo "$what" | sed 's/`//g; s/ *$//')" \
        "$(echo "$how" | sed 's/^ *//; s/ *$//')" "$fetch"
done <table
stop

echo "$rows damages and $fetches fetches as the table says, $skipped that this" \
    "user cannot do"
[ "$rows" -ge 40 ] && [ "$fetches" -ge 12 ] || fail "rows of the table are lost"
finish
