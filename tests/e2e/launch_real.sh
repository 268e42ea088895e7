#!/bin/sh
# launch_real.sh - radsubmit --launch with Open MPI's mpirun and OpenSSH's ssh, as
# they come: --local's picture, the key in no argument, nothing left behind, also
# when radsubmit is killed.  Slurm's srun has slurm.sh.
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
sshd=$(PATH=$PATH:/usr/sbin command -v sshd)
command -v mpirun >/dev/null || [ -n "$sshd" ] || {
    echo "SKIP: neither mpirun nor sshd here"
    exit 77
}
# in a container of one user that is root
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_plm=isolated

room=$scenes/room.rad
quick="-vf $scenes/room.vf -x 120 -y 90 -ab 1 -ad 64 -as 16 --oversample=1
--threads=1"
slow="-vf $scenes/room.vf -x 900 -y 675 -ab 2 -aa .1 -ar 128 -ad 1024 -as 256
-ps 2 --oversample=1 --threads=1 --progress=never"

workers()
{
    pgrep -f -- "$top_builddir/radd --embedded --launched" |
        while read -r pid; do # by this test's own radsubmit
            tr '\0' '\n' 2>/dev/null <"/proc/$pid/cmdline" |
                grep -qxF -e "--coordinator=$host:$port" && echo "$pid"
        done
}
none()
{
    [ -z "$(workers)" ] && ! ls -d "$work"/radsubmit.* >/dev/null 2>&1
}
two()
{
    [ "$(workers | wc -l)" -ge 2 ]
}

# try NAME OPTION...
host=127.0.0.1
port=$((12000 + 2 * ($$ % 10000))) # and the next one: below those that others get
try()
{
    name=$1
    shift
    # shellcheck disable=SC2086
    "$radsubmit" $quick "$@" --address=$host:$port -o "$name.hdr" "$room" \
        2>"$name.err" || fail "$name: exit status $?: $(cat "$name.err")"
    until_true 15 none || fail "$name: left: $(workers)"
    cmp "$name.hdr" local.hdr || fail "$name: another picture than --local's"
}

# killed NAME OPTION...: while it renders
killed()
{
    name=$1
    shift
    # shellcheck disable=SC2086
    "$radsubmit" $slow "$@" --address=$host:$port -o "$name.hdr" "$room" \
        2>"$name.err" &
    pid=$!
    until_true 30 two || fail "$name: no two workers: $(cat "$name.err")"
    for p in $(pgrep -f "$top_builddir/radd --embedded --launched"); do
        tr '\0' ' ' <"/proc/$p/cmdline" 2>/dev/null
    done | grep -q 'worker:launched' && fail "$name: the key is an argument"
    grep -rqs 'worker:launched' "$work"/radd-launched-* &&
        fail "$name: the key is on the disk"
    kill -KILL $pid
    wait $pid 2>/dev/null
    until_true 60 none || fail "$name: left: $(workers)"
}

# shellcheck disable=SC2086
"$radsubmit" --local $quick -o local.hdr "$room" 2>local.err ||
    fail "local: $(cat local.err)"

if command -v mpirun >/dev/null; then
    try mpirun --launch="mpirun -np 2" --workers=2
    killed mpirun_killed --launch="mpirun -np 2" --workers=2
else
    echo "no mpirun here: left out"
fi

# a server of this test's own, for its own key
ssh_start()
{
    mkdir -p ssh && chmod 700 ssh
    ssh-keygen -q -t ed25519 -N '' -f ssh/host && ssh-keygen -q -t ed25519 \
        -N '' -f ssh/key && cp ssh/key.pub ssh/authorized || return 1
    [ "$(id -u)" -ne 0 ] || mkdir -p /run/sshd
    sshport=$((port + 1))
    cat >ssh/config <<END
Port $sshport
ListenAddress 127.0.0.1
HostKey $work/ssh/host
AuthorizedKeysFile $work/ssh/authorized
PidFile none
StrictModes no
UsePAM no
PermitRootLogin yes
END
    "$sshd" -D -f "$work/ssh/config" -E "$work/ssh/log" &
    sshpid=$!
    ssh="ssh -p $sshport -i $work/ssh/key -o BatchMode=yes -o UserKnownHostsFile=$work/ssh/known -o StrictHostKeyChecking=no -o LogLevel=ERROR 127.0.0.%d"
    # the address of worker 1 is the only one that listens: all go there
    ssh=$(echo "$ssh" | sed 's/127.0.0.%d/-o HostName=127.0.0.1 ws%d/')
    until_true 10 $(echo "$ssh" | sed 's/%d/1/') true
}
if [ -n "$sshd" ] && ssh_start; then
    try ssh --launch="$ssh" --workers=2
    killed ssh_killed --launch="$ssh" --workers=2
    kill $sshpid
    wait $sshpid 2>/dev/null
else
    echo "no sshd here, or none that lets this user in: left out"
    cat ssh/log 2>/dev/null
fi
finish
