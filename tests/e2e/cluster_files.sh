#!/bin/sh
# cluster_files.sh - files of scenes are had by right of a job alone: nobody
# learns what others have sent, and a worker gets what it is to render
. "${top_srcdir:-.}/tests/e2e/cluster.sh"

room=$scenes/room.rad
make_keys
make_key user:bob bob.key
coord_start # with the keys that are there

# submit KEY NAME: a job of the same scene as all others here
submit()
{
    "$radsubmit" --coordinator="$tcp" --key="$1" --stats="$2.json" \
        -o "$2.hdr" -vf "$scenes/room.vf" -x 30 -y 20 -ab 0 "$room" \
        >stdout 2>stderr </dev/null || fail "$2: $(cat stderr)"
}

# sent NAME: how much of its scene that job sent: all or nothing
sent()
{
    python3 - "$1.json" <<'END'
import json, sys
s = json.load(open(sys.argv[1]))["scene"]
print({s["bundle_bytes"]: "all", 0: "nothing"}.get(s["sent_bytes"], "some"))
END
}

# ask ROLE HASH...: what the coordinator answers to an OFFER of these, or a WANT
# of a worker, as names of messages with how many hashes a WANT has
ask()
{
    python3 - "$sock" "$@" <<'END'
import struct, sys
from wire import *
worker = sys.argv[2] == 'worker'
link = Link(sys.argv[1], WORKER if worker else USER)
hashes = b''.join(bytes.fromhex(h) for h in sys.argv[3:])
link.send(WANT if worker else OFFER,
          struct.pack('>I', len(hashes) // 32) + hashes)
link.send(PING, struct.pack('>Q', 7))
while True: # the answer to PING is behind all others
    kind, body = link.receive()
    if kind == PONG:
        break
    if kind == WANT:
        print('WANT', struct.unpack('>I', body[:4])[0])
    elif kind == CHUNK:
        print('CHUNK')
END
}

# submit_frames HASH: what a user hears whose job has its frames in that file
submit_frames()
{
    python3 - "$sock" "$1" <<'END'
import os, struct, sys
from wire import *
link = Link(sys.argv[1])
hash = bytes.fromhex(sys.argv[2])
job = os.urandom(16) + hash + text(b'n') + text(b'') + text(b'') + text(b'')
job += struct.pack('>IQiIBBIIQdI', 0, 0, 0, 128, 0, 0, 0, 1, 1, 0, 0)
job += struct.pack('>I', 1) + hash + struct.pack('>I', 1) + hash
job += struct.pack('>II', 1, 1) + text(b'') + struct.pack('>BdII', 0, 0, 0, 0)
link.send(SUBMIT, job)
while True:
    kind, body = link.receive()
    if kind == FAILED:
        print(struct.unpack('>H', body[16:18])[0], body[20:-1].decode())
        break
END
}

worker_start 1 1
until_true 30 n_workers 1 || fail "the worker does not come"
submit user.key first
submit user.key again
submit bob.key bobs
cmp first.hdr bobs.hdr || fail "the pictures differ"
[ "$(sent first)" = all ] || fail "ana's first job sent $(sent first)"
[ "$(sent again)" = nothing ] || fail "ana's second job sent $(sent again)"
[ "$(sent bobs)" = all ] || fail "bob learns what ana sent: $(sent bobs)"

# one of them, of whoever came by the socket, who has sent none
# shellcheck disable=SC2046 # hashes are words
set -- $(ls state/files)
[ $# -ge 1 ] || fail "no files are stored"
answer=$(ask user "$@")
[ "$answer" = "WANT $#" ] || fail "a stranger hears '$answer'"
stored=$(submit_frames "$1") || fail "no answer to a job whose frames are there"
absent=$(submit_frames "$(printf '%064d' 0)") || fail "no answer to the other"
[ "$stored" = "$absent" ] ||
    fail "a stranger hears '$stored' of frames, and '$absent' of none"
answer=$(ask worker "$@")
[ -z "$answer" ] || fail "a worker without a job gets '$answer'"

# steal NAMED: how a job ends that renders the stored scene, which its user has
# not sent, and has the manifest alone among its files, or nothing
steal()
{
    python3 - "$sock" state/files "$1" <<'END'
import os, struct, sys
from wire import *
for name in os.listdir(sys.argv[2]):
    with open(os.path.join(sys.argv[2], name), "rb") as f:
        if f.read(11) == b"radd-bundle":
            f.seek(0)
            manifest, body = bytes.fromhex(name), f.read()
link = Link(sys.argv[1])
named = []
if sys.argv[3] == "manifest": # as if its user knew the name of a scene
    link.send(CHUNK, manifest + struct.pack(">QQI", 0, len(body), len(body)) + body)
    named = [manifest]
view = b"-vtv -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 45 -vv 45"
link.send(SUBMIT, os.urandom(16) + manifest + text(b"theft") +
     text(b"-x 8 -y 8 -ab 0") + text(b"") + text(b"") +
     struct.pack(">IQiIBBIIQdI", 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0) +
     struct.pack(">I", len(named)) + b"".join(named) +
     struct.pack(">IIII", 1, 0, 8, 8) + text(view) +
     text(b"") + struct.pack(">BdII", 0, 0, 0, 0))
while True:
    kind, body = link.receive()
    if kind == DONE:
        print("DONE")
        break
    if kind == FAILED:
        print(body[20:-1].decode())
        break
END
}

for named in nothing manifest; do
    answer=$(steal "$named")
    case $answer in
    *"none of the job's files"*) ;;
    *) fail "another's scene, of which $named is named: '$answer'" ;;
    esac
done

# A file that the coordinator's disk has lost fails its job, and costs the worker
# neither its connection nor other jobs.
ls state/files >before
cat >sun.rad <<'END'
void light bright
0 0 3 1e6 1e6 1e6
bright source sun
0 0 4 0 0 1 .5
END
"$radctl" --coordinator="$sock" drain w1 || fail "drain"
id=$("$radsubmit" --coordinator="$tcp" --key=user.key --detach \
    -vf "$scenes/room.vf" -x 30 -y 20 -ab 0 sun.rad 2>stderr) ||
    fail "submit: $(cat stderr)"
# shellcheck disable=SC2010 # names are hashes
for name in $(ls state/files | grep -vxFf before); do
    rm "state/files/$name"
done
"$radctl" --coordinator="$sock" undrain w1 || fail "undrain"
has_failed() { "$radctl" --coordinator="$sock" jobs | grep -q "^$id *failed"; }
until_true 30 has_failed || fail "a job whose files are lost does not fail"
grep -q 'coordinator lost' w1.log && fail "the worker lost its connection"
submit user.key later

# what a user has is known in the next life, too
kill -KILL "$coord_pid"
wait "$coord_pid" 2>/dev/null
coord_start
worker_start 2 1 # the port is another one
submit bob.key after
[ "$(sent after)" = nothing ] ||
    fail "a restart forgets what bob has: $(sent after)"
eval "kill -KILL \$pid_1"
workers=2
cluster_finish
