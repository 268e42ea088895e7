# What the scripts of this folder share; they set $here, $folder and $results.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # the scripts set and use them

die()
{
    echo "${0##*/}: $*" >&2
    exit 64
}

# The comment at the script's head, as help.
usage()
{
    sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2
    exit 64
}

# Sets $build, makes $results and $folder absolute, and a $tmp that goes with the
# script.
begin() # BUILD PROGRAM...: that have to be there
{
    build=$(cd "$1" && pwd)
    shift
    for program; do
        [ -x "$build/$program" ] || die "no $program in '$build'"
    done
    mkdir -p "$results"
    results=$(cd "$results" && pwd)
    [ -z "$folder" ] || folder=$(cd "$folder" && pwd)
    tmp=$(mktemp -d "${TMPDIR:-/tmp}/bench.XXXXXX")
    trap 'rm -rf "$tmp"' EXIT
    trap 'exit 1' INT TERM HUP
}

# Where a scene is: sets $at, $file, $view, $extra, its own options, and
# $reference, a converged picture; "" of the room.
find_scene() # NAME
{
    extra='' reference=''
    case $1 in
    cornell)
        at=$folder/cornell file=cornell.rad view=box.vf
        reference=$at/ref/cornell_box_conv.hdr
        ;;
    night | day)
        at=$folder/office file=$1.rad view=norm.vf
        reference=$at/ref/$1_norm_conv.hdr
        ;;
    virtual)
        at=$folder/virtual file=plain.rad view=back.vf extra='-dr 2'
        reference=$at/ref/plain_back_conv.hdr
        ;;
    mirror)
        at=$folder/mirror file=mirror.rad view=inside.vf extra='-ab 3'
        reference=$at/ref/mirror_inside_conv.hdr
        ;;
    room) at=$here/../examples/reading-room file=room.rad view=room.vf ;;
    *) die "no scene '$1'" ;;
    esac
}

# Sets $width and $height from a picture's header.
size_of() # PICTURE
{
    # shellcheck disable=SC2046 # four words
    set -- $(LC_ALL=C sed -n '/^[-+][XY] [0-9]* [-+][XY] [0-9]*$/{p;q}' "$1" |
        tr -d '\0')
    [ $# -eq 4 ] || die "a reference without a size"
    height=$2 width=$4
}
