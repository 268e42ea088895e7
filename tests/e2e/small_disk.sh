# shellcheck shell=sh
# small_disk.sh - a disk that can be filled; read with "." before client_lib.sh
#
# It is a tmpfs of 16 MiB where one may be mounted, else one that
# tests/tools/disaster.so calls full: then FULL_TMPFS is no.
if [ -z "${FULL_TMPFS:-}" ]; then
    FULL_TMPFS=no
    unshare -rm true 2>/dev/null && FULL_TMPFS=yes
    export FULL_TMPFS
    [ $FULL_TMPFS = no ] || exec unshare -rm "$0"
fi

# small_disk FOLDER: it is on one from now on
small_disk()
{
    disk=$1
    mkdir -m 700 "$disk" # a daemon takes no folder that a group may write to
    [ "$FULL_TMPFS" = yes ] &&
        mount -t tmpfs -o size=16m,mode=700 none "$disk" && return
    [ -e "$top_builddir/tests/tools/disaster.so" ] || exit 77
    FULL_TMPFS=no
    LD_PRELOAD=$top_builddir/tests/tools/disaster.so
    DISASTER_DIR=$work/$disk/ DISASTER_ROOM=$work/full
    export LD_PRELOAD DISASTER_DIR DISASTER_ROOM
}

fill()
{
    if [ "$FULL_TMPFS" = no ]; then
        touch full
    else
        dd if=/dev/zero of="$disk/ballast" bs=64k 2>/dev/null
        dd if=/dev/zero of="$disk/crumbs" bs=512 2>/dev/null
    fi
}

make_room()
{
    rm -f full "$disk/ballast" "$disk/crumbs"
}
