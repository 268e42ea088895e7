#!/bin/sh
# radd_refused.sh - radd ends with the status that a coordinator refuses it
# with, and says why
. "${top_srcdir:-.}/tests/e2e/client_lib.sh"

# A coordinator that answers whatever comes with the recorded REFUSE, its
# status replaced.
cat >coordinator.py <<'END'
import socket, sys
status, golden, path = int(sys.argv[1]), sys.argv[2], sys.argv[3]
refuse = bytearray(bytes.fromhex(open(golden).read()))
refuse[16:18] = status.to_bytes(2, "big")
s = socket.socket(socket.AF_UNIX)
s.bind(path)
s.listen()
c, _ = s.accept()
c.recv(1)
c.sendall(refuse)
while c.recv(4096):
    pass
END

# refused STATUS-ON-THE-WIRE EXIT-STATUS
refused()
{
    python3 coordinator.py "$1" "$top_srcdir/tests/golden/REFUSE.hex" \
        "$work/$1.sock" &
    peer=$!
    until_true 30 test -S "$work/$1.sock" || fail "no coordinator"
    expect "$2" "is not spoken here" "refused with $1" \
        "$radd" --coordinator="$work/$1.sock" --name=w \
        --listen=127.0.0.1:0 --cache="$work/cache"
    wait $peer
}

refused 76 76
refused 77 77
refused 0 76     # a refusal is no success
refused 256 76   # nor is what a process cannot say
finish
