# wire.py - connections to a coordinator's Unix socket, for tests that speak its
# protocol (doc/protocol.md) themselves
import socket
import struct
import sys

HELLO, WELCOME, PING, PONG, OFFER, WANT, CHUNK = 1, 2, 4, 5, 10, 11, 12
SUBMIT, DONE, FAILED, FETCH, QUERY = 20, 23, 24, 28, 29
WORKER, USER = 1, 2


def text(s):
    return struct.pack(">H", len(s)) + s + b"\0"


def frame(kind, payload):
    return b"RADD" + struct.pack(">HHII", kind, 0, 1, len(payload)) + payload


def connect(path):
    s = socket.socket(socket.AF_UNIX)
    s.settimeout(60)
    s.connect(path)
    return s


class Link:
    """One that was welcome; a worker's name is thief."""

    def __init__(self, path, role=USER):
        self.s = connect(path)
        self.send(HELLO, struct.pack(">HHB", 1, 1, role)
                  + text(b"thief" if role == WORKER else b"") + text(b"t")
                  + text(b"") + struct.pack(">HQ", 1, 0))
        assert self.receive()[0] == WELCOME, "not welcome"

    def send(self, kind, payload):
        self.s.sendall(frame(kind, payload))

    def get(self, n):
        b = b""
        while len(b) < n:
            part = self.s.recv(n - len(b))
            if not part:
                sys.exit("closed")
            b += part
        return b

    def receive(self):
        kind, n = struct.unpack(">4xH6xI", self.get(16))
        return kind, self.get(n)
