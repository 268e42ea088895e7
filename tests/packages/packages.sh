#!/usr/bin/env bash
# packages.sh TARBALL [SUITE] - the Debian packages, as an administrator meets them
#
# In clean trees of a release (bookworm where none is named): build them from the
# tarball; ask its lintian; install, render as an ordinary user, remove, purge; and
# boot such a tree with systemd (booted.sh), where that is allowed.  Needs root,
# mmdebstrap and a mirror with its keys; exit status 77 says that something of that
# is absent.
set -u
# what is mounted here goes with this process
[ -n "${RADD_MOUNTS-}" ] || [ "$(id -u)" -ne 0 ] ||
    RADD_MOUNTS=own exec unshare --mount -- "$0" "$@"
here=$(cd "$(dirname "$0")" && pwd)
tarball=$(realpath "${1?the tarball of make dist}") || exit 1
work=$(mktemp -d /var/tmp/radd-packages.XXXXXX) || exit 1
suite=${2-bookworm}
trap 'umount "$work"/*/proc 2>/dev/null
    rm -rf --one-file-system "$work"' EXIT
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8

skip()
{
    echo "skipped: $*"
    exit 77
}

die()
{
    echo "FAILED: $*"
    [ ! -s "$work/log" ] || tail -n 40 "$work/log"
    exit 1
}

# A command whose output is of interest only if it fails.
quietly()
{
    "$@" >"$work/log" 2>&1 || die "$*"
}

in_tree() # NAME COMMAND...
{
    local tree=$work/$1
    shift
    chroot "$tree" "$@"
}

# A copy of the tree as mmdebstrap made it, with /proc.
tree()
{
    cp -a "$work/base" "$work/$1" && mount -t proc proc "$work/$1/proc" ||
        die "tree $1"
}

build_packages()
{
    tree build
    tar -C "$work/build/root" -xf "$tarball" || die "tarball"
    in_tree build sh -c 'mv /root/radd-* /src && cd /src && exec apt-get \
        build-dep -y -q --no-install-recommends ./' >"$work/log" 2>&1 ||
        die "build-dep"
    # optimized between files at link time, as some distributions do by default
    quietly in_tree build sh -c "cd /src && DEB_BUILD_OPTIONS='nocheck \
        parallel=$(nproc)' DEB_CFLAGS_APPEND=-flto=auto \
        DEB_LDFLAGS_APPEND=-flto=auto dpkg-buildpackage -us -uc -b"
    in_tree build sh -c 'cd /src && mkdir other && cd other &&
        exec ../configure --silent' >"$work/log" 2>&1 ||
        die "after the packages, the tree builds nothing else"
    quietly in_tree build apt-get install -y -q --no-install-recommends lintian
    in_tree build sh -c 'lintian --allow-root --fail-on error,warning \
        /radd_*.changes' || die "lintian"
    mkdir "$work/debs" && mv "$work"/build/*.deb "$work"/build/*.changes \
        "$work"/build/*.buildinfo "$work/debs" || die "packages"
    umount "$work/build/proc" && rm -rf --one-file-system "$work/build"
}

# The same packages as the next version.
next_version()
{
    local deb
    mkdir "$work/next"
    for deb in "$work"/debs/*.deb; do
        case $deb in *-dbgsym_*) continue ;; esac
        rm -rf "$work/open"
        dpkg-deb -R "$deb" "$work/open" &&
            sed -i -e 's/^Version: .*/&+next/' \
                -e '/^Depends:/s/(= \([^)]*\))/(= \1+next)/g' \
                "$work/open/DEBIAN/control" &&
            dpkg-deb --root-owner-group -b "$work/open" "$work/next" \
                >/dev/null || die "next version of $deb"
    done
}

files_of() # NAME: what an administrator would find left
{
    in_tree "$1" find / -xdev \( -path /proc -o -path /root -o -path /tmp -o \
        -path /home -o -path /var/lib/dpkg -o -path /var/lib/apt -o \
        -path /var/cache -o -path /var/log \) -prune -o -print | sort
}

install_packages() # NAME FURTHER...
{
    local name=$1
    shift
    mkdir "$work/$name/root/debs" "$work/$name/root/next" &&
        cp "$work"/debs/*.deb "$work/$name/root/debs" &&
        rm "$work/$name"/root/debs/*-dbgsym_* &&
        cp "$work"/next/*.deb "$work/$name/root/next" || die "copy"
    quietly in_tree "$name" sh -c "exec apt-get install -y -q \
        --no-install-recommends $* /root/debs/*.deb"
    in_tree "$name" useradd --create-home ana || die "useradd"
    cp "$here/room.rad" "$work/$name/home/ana" || die "scene"
}

# Installed, and used by somebody who is not root.
try_installed()
{
    tree installed
    # what the packages need stays when they are purged
    local deb needs=systemd
    for deb in "$work"/debs/*.deb; do
        needs=$needs,$(dpkg-deb -f "$deb" Depends)
    done
    needs=$(tr , '\n' <<<"$needs" | grep -vE '^ *(rad|$)' | sort -u | paste -sd ,)
    quietly in_tree installed apt-get satisfy -y -q --no-install-recommends \
        "$needs"
    files_of installed >"$work/before"
    install_packages installed
    in_tree installed id radd >/dev/null || die "no user radd"
    # what renders alone needs the service of no coordinator
    quietly in_tree installed dpkg --remove radcoord
    quietly in_tree installed su ana -c 'cd && radsubmit --local \
        -vp 2 1 1.5 -vd 0 1 0 -x 64 -y 64 -ab 1 -o a.hdr room.rad'
    grep -q '^#?RADIANCE' "$work/installed/home/ana/a.hdr" || die "no picture"
    in_tree installed userdel --remove ana 2>/dev/null
    quietly in_tree installed dpkg --remove radd radcoord radweb radd-client \
        radd-doc
    [ -e "$work/installed/etc/radd/radcoord.conf" ] ||
        die "a conffile went with remove"
    quietly in_tree installed dpkg --purge radd radcoord radweb radd-client
    files_of installed >"$work/after"
    diff "$work/before" "$work/after" | grep -vE '^[<>] /(etc/(passwd|group|g?shadow|sub[ug]id)-?|var/mail|run/.*)$' |
        grep '^[<>]' && die "left behind by purge"
    umount "$work/installed/proc" && rm -rf --one-file-system "$work/installed"
    echo "installed, used, removed, purged"
}

# With systemd as the first process.
try_booted()
{
    tree booted
    install_packages booted systemd systemd-sysv dbus procps curl openssl
    umount "$work/booted/proc"
    cp "$here/booted.sh" "$work/booted/root/" || die "booted.sh"
    cat >"$work/booted/etc/systemd/system/booted.service" <<'EOF'
[Unit]
After=multi-user.target
[Service]
Type=oneshot
ExecStart=/bin/bash /root/booted.sh
ExecStopPost=/bin/systemctl --no-block poweroff
StandardOutput=file:/root/booted.log
StandardError=file:/root/booted.log
[Install]
WantedBy=default.target
EOF
    in_tree booted systemctl enable -q booted.service || die "enable"
    timeout 1800 systemd-nspawn --register=no --keep-unit -b --private-network \
        --console=pipe -D "$work/booted" </dev/null >"$work/log" 2>&1
    if ! [ -s "$work/booted/root/booted.log" ]; then
        tail -n 3 "$work/log"
        echo "skipped: systemd does not boot in a container here"
        return
    fi
    cat "$work/booted/root/booted.log"
    grep -q '^all of it$' "$work/booted/root/booted.log" || die "booted.sh"
}

[ "$(id -u)" -eq 0 ] || skip "not root"
for p in mmdebstrap dpkg-deb; do
    command -v $p >/dev/null || skip "no $p"
done
mmdebstrap --mode=root --variant=minbase $suite "$work/base" >"$work/log" \
    2>&1 || skip "no tree of $suite: $(tail -n 1 "$work/log")"
# a tree that is thrown away need not be on the disk
echo force-unsafe-io >"$work/base/etc/dpkg/dpkg.cfg.d/unsafe-io"
quietly in_tree base apt-get update -q
build_packages
next_version
try_installed
if command -v systemd-nspawn >/dev/null; then
    try_booted
else
    echo "skipped: no systemd-nspawn"
fi
