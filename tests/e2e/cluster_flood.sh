#!/bin/sh
# cluster_flood.sh - a user who asks and asks and never reads an answer costs
# the coordinator little memory, and is let go
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"
. "$top_srcdir/tests/e2e/cluster.sh"
set -u

cluster_start 1 1
python3 - "$sock" "$coord_pid" <<'PYTHON' || fail "the flood: see above"
import socket, struct, sys

def message(number, payload):
    return b'RADD' + struct.pack('>HHII', number, 0, 1, len(payload)) + payload

def text(s):
    return struct.pack('>H', len(s)) + s + b'\0'

def resident_mib():
    with open(f'/proc/{sys.argv[2]}/status') as f:
        for line in f:
            if line.startswith('VmRSS:'):
                return int(line.split()[1]) / 1024

hello = struct.pack('>HHB', 1, 1, 2) + text(b'') + text(b'flood') + text(b'')
hello += struct.pack('>HQ', 0, 0)
queries = message(29, b'\1' + text(b'')) * 3000
before = resident_mib()
s = socket.socket(socket.AF_UNIX)
s.connect(sys.argv[1])
s.sendall(message(1, hello))
assert s.recv(6)[4:6] == b'\0\2', 'not welcome'
s.settimeout(2) # it may be made to wait for ever
asked = 0
try:
    while asked < 300 * 3000:
        s.sendall(queries)
        asked += 3000
except (socket.timeout, OSError):
    pass
grown = resident_mib() - before
print(f'{asked} questions, {grown:.0f} MiB more')
# answers to all of them would be 340 MiB; a sanitizer keeps freed ones
sys.exit(grown > 200)
PYTHON
until_true 30 n_workers 1 || fail "the worker is not there any more"
cluster_stop
finish
