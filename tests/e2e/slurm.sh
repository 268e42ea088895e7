#!/bin/sh
# slurm.sh - radsubmit --launch=srun under Debian's Slurm, two nodes of it on
# this machine: --local's picture, also when a node is killed, a job's time is
# over or it is queued again; and a standing coordinator whose workers are batch
# jobs (etc/slurm/radd.sbatch), which drain before their time is over
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

PATH=$PATH:/usr/sbin:/sbin
for p in munged slurmctld slurmd srun salloc sbatch scancel scontrol squeue; do
    command -v $p >/dev/null || {
        echo "slurm: no $p here (Debian: slurm-wlm, munge): not tested"
        rm -rf "$work"
        exit 77
    }
done
[ "$(id -u)" = 0 ] || {
    echo "slurm: its daemons want to be root: not tested"
    rm -rf "$work"
    exit 77
}

free_port()
{
    python3 -c 'import socket
s = socket.socket()
s.bind(("127.0.0.1", 0))
print(s.getsockname()[1])'
}

slurm_down()
{
    for f in "$work"/slurm/*.pid; do
        [ -f "$f" ] && kill -9 "$(cat "$f")" 2>/dev/null
    done
    pkill -9 -f "slurmstepd.*$work" 2>/dev/null
    left_over | xargs -r kill -9 2>/dev/null
}
trap slurm_down EXIT

mkdir -p slurm/state
chmod 755 "$work" slurm
host=$(hostname -s)
cat >slurm/slurm.conf <<END
ClusterName=radd
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$work/slurm/munge.sock
SlurmUser=root
SlurmdUser=root
SlurmctldPort=$(free_port)
SlurmctldPidFile=$work/slurm/slurmctld.pid
SlurmdPidFile=$work/slurm/slurmd-%n.pid
SlurmctldLogFile=$work/slurm/slurmctld.log
SlurmdLogFile=$work/slurm/slurmd-%n.log
SlurmdSpoolDir=$work/slurm/spool-%n
StateSaveLocation=$work/slurm/state
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,bf_interval=1,requeue_delay=0
ReturnToService=2
KillWait=2
SlurmdTimeout=5
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$(free_port) CPUs=2
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$(free_port) CPUs=2
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF="$work/slurm/slurm.conf"
head -c 128 /dev/urandom >slurm/munge.key
chmod 600 slurm/munge.key
munged --force --key-file="$work/slurm/munge.key" \
    --socket="$work/slurm/munge.sock" --pid-file="$work/slurm/munge.pid" \
    --log-file="$work/slurm/munge.log" --seed-file="$work/slurm/munge.seed" \
    2>munged.err || { cat munged.err; echo "slurm: no munge: not tested"; exit 77; }
slurmctld -c
slurmd -N n1
slurmd -N n2
idle()
{
    [ "$(sinfo -h -N -o %t | grep -c '^idle$')" = 2 ]
}
until_true 30 idle || { echo "slurm does not start: not tested"; exit 77; }

room=$scenes/room.rad
small="-vf $scenes/room.vf -x 120 -y 90 -ab 1 -ad 64 -as 16 --oversample=1
--threads=1"
large="-vf $scenes/room.vf -x 1200 -y 900 -ab 1 -ad 512 -as 64 --oversample=1
--threads=1 --progress=never"
# shellcheck disable=SC2086
"$radsubmit" --local $small -o small.hdr "$room" 2>err || fail "$(cat err)"
# shellcheck disable=SC2086
"$radsubmit" --local $large -o large.hdr "$room" 2>err || fail "$(cat err)"

# the manual: two nodes, a worker on each
# shellcheck disable=SC2086
salloc -Q -N2 "$radsubmit" --launch=srun --workers=2 $small -o two.hdr "$room" \
    2>two.err || fail "two nodes: $(cat two.err)"
cmp small.hdr two.hdr || fail "two nodes give another picture"
grep -q '^radsubmit: 2 of 2 workers there: ' two.err || fail "$(cat two.err)"
grep -q srun: two.err && fail "srun has something to say: $(cat two.err)"
until_true 10 idle || fail "the nodes are not free"
ls -d "$work"/radd-launched-* 2>/dev/null && fail "workers left their files"

# the worker on a node
on_node() # NODE
{
    for p in $(launched); do
        tr '\0' '\n' 2>/dev/null <"/proc/$p/environ" |
            grep -qx "SLURMD_NODENAME=$1" && echo "$p"
    done
}

both_work() # ERR
{
    grep -q '^radsubmit: job' "$1" && [ -n "$(on_node n1)" ] &&
        [ -n "$(on_node n2)" ]
}

# a node killed in the middle: its slurmd, its step, its worker
# shellcheck disable=SC2086
salloc -Q -k -N2 "$radsubmit" --launch=srun --workers=2 $large -o node.hdr \
    "$room" 2>node.err &
pid=$!
until_true 30 both_work node.err || fail "node: $(cat node.err)"
victim=$(on_node n2)
step=$(ps -o ppid= -p $victim)
kill -9 "$(cat slurm/slurmd-n2.pid)" $step $victim
wait $pid || fail "node: exit status $?: $(cat node.err)"
cmp large.hdr node.hdr || fail "a killed node changes the picture"
rm -f slurm/slurmd-n2.pid
slurmd -N n2
scontrol update nodename=n2 state=resume 2>/dev/null
until_true 60 idle || fail "n2 does not come back: $(sinfo -N)"

# a batch job: cancelled, its nodes are free and nothing runs on
script() # NAME OPTIONS...
{
    name=$1
    shift
    cat >"$name.sh" <<END
#!/bin/sh
#SBATCH --nodes=2 --output=$work/$name.err --job-name=$name --open-mode=append
export TMPDIR=$work
$radsubmit --launch=srun --workers=2 $* -o $work/$name.hdr $room
echo \$? >$work/$name.status
END
    id=$(sbatch --parsable "$name.sh") || fail "$name: sbatch"
}

no_workers()
{
    [ -z "$(of_launchers)" ] && idle
}

# so large that it cannot end before it is cancelled
# shellcheck disable=SC2086
script cancelled $large -x 2400 -y 1800
until_true 30 both_work cancelled.err || fail "cancelled: $(cat cancelled.err)"
scancel "$id"
until_true 30 no_workers || fail "scancel leaves something: $(squeue; sinfo -N)"
[ ! -e cancelled.hdr ] || fail "a cancelled job has a picture"

# queued again in the middle: it begins anew and ends
# shellcheck disable=SC2086
script again $large
until_true 30 both_work again.err || fail "again: $(cat again.err)"
scontrol requeue "$id" || fail "requeue"
soon() # not in two minutes, as Slurm has it, nor in the second of its end
{
    [ "$(squeue -h -j "$id" -o '%T %r')" = "PENDING BeginTime" ] &&
        scontrol update jobid="$id" starttime=now+3
}
until_true 20 soon || fail "starttime: $(squeue)"
ended()
{
    [ "$(cat "$1.status" 2>/dev/null)" = "$2" ]
}
until_true 30 ended again 0 || fail "again: $(cat again.err; squeue)"
cmp large.hdr again.hdr || fail "a job that was queued again: another picture"
[ "$(grep -c '^radsubmit: job' again.err)" = 2 ] || fail "again: $(cat again.err)"
until_true 30 no_workers || fail "again leaves something: $(squeue; sinfo -N)"

# the other way: a standing coordinator whose workers are batch jobs; the first
# one's time is over in the middle, and no unit is done twice
mkdir keys
"$radctl" key add worker:one --keys=keys/all >keys/one || fail "key add"
"$radctl" key add worker:two --keys=keys/all >keys/two || fail "key add"
chmod 600 keys/*
"$radcoord" --listen=127.0.0.1:0 --socket="$work/socket" --state="$work/coord" \
    --keys=keys/all --ports-file=ports --log-level=info 2>coord.log &
coord=$!
until_true 10 test -s ports || fail "radcoord: $(cat coord.log)"
address=$(sed -n 's/^tcp //p' ports)
batch() # NAME SECONDS-BEFORE OPTIONS...
{
    RADD=$radd RADD_COORDINATOR=$address RADD_KEY=$work/keys/$1 \
        sbatch --parsable --output="$work/$1.log" --nodes=1 \
        --signal="B:TERM@$2" "$top_srcdir/etc/slurm/radd.sbatch" --threads=1 \
        --listen=127.0.0.1:0 --pixel-s=0
}
first=$(batch one 10)
there()
{
    "$radctl" --coordinator="$work/socket" workers | grep -q "^$1 "
}
until_true 30 there one || fail "no worker came: $(cat one.log coord.log)"
# shellcheck disable=SC2086
"$radsubmit" --coordinator="$work/socket" ${large%--threads*} --progress=never \
    --stats=batch.json -o batch.hdr "$room" 2>batch.err &
pid=$!
until_true 30 grep -q '^radsubmit: job' batch.err || fail "batch: $(cat batch.err)"
second=$(batch two 10)
until_true 30 there two || fail "no second worker: $(cat two.log)"
# Slurm sends this signal when --signal and --time say so; a minute is its least
scancel --batch --signal=TERM "$first"
wait $pid || fail "batch: $(cat batch.err coord.log)"
cmp large.hdr batch.hdr || fail "batch workers: another picture"
python3 - <<'END' || fail "batch: units were done again"
import json
s = json.load(open("batch.json"))
assert s["totals"]["units_redone"] == 0, s["totals"]
END
gone()
{
    ! squeue -h -o %i | grep -qx "$1"
}
until_true 20 gone "$first" || fail "the drained worker's job goes on"
grep -q 'stopping signal=15' one.log || fail "one: $(cat one.log)"
scancel --batch --signal=TERM "$second"
until_true 20 gone "$second" || fail "the second worker's job goes on"
ls -d "$work"/radd-[0-9]* 2>/dev/null && fail "batch workers left their files"
kill $coord
wait $coord
slurm_down
finish
