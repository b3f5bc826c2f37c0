"""A server of `palpate touch` and a viewer of it, with the standard library only."""
import base64
import hashlib
import json
import os
import re
import select
import socket
import struct
import subprocess
import threading
import time
import urllib.request

PROTOCOL = "palpate-touch-1"
GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"  # of RFC 6455


class Refused(Exception):
    """The server did not accept the WebSocket; `status` is that of HTTP."""

    def __init__(self, status):
        super().__init__(f"status {status}")
        self.status = status


class Viewer:
    """One WebSocket. `scene` and `geometry` are the newest ones, `frames` all frames since the last scene."""

    def __init__(self, port, token, origin=None, host=None, protocol=PROTOCOL, receive_buffer=0):
        self.socket = socket.socket()
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.settimeout(20)
        self.socket.connect(("127.0.0.1", port))
        host = host or f"127.0.0.1:{port}"
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET /socket?token={token} HTTP/1.1", f"Host: {host}", "Upgrade: websocket",
                 "Connection: Upgrade", f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13"]
        if protocol:
            lines.append(f"Sec-WebSocket-Protocol: {protocol}")
        if origin != "":
            lines.append(f"Origin: {origin or 'http://' + host}")
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self.bytes = b""
        while b"\r\n\r\n" not in self.bytes:
            part = self.socket.recv(4096)
            if not part:
                raise Refused(0)
            self.bytes += part
        head, self.bytes = self.bytes.split(b"\r\n\r\n", 1)
        status = int(head.split()[1])
        if status != 101:
            self.socket.close()
            raise Refused(status)
        accept = base64.b64encode(hashlib.sha1((key + GUID).encode()).digest())
        assert accept in head, head
        self.scene, self.geometry, self.frames, self.texts, self.states = None, None, [], [], []
        self.closed = None

    def close(self):
        self.socket.close()

    def _take(self, size):
        while len(self.bytes) < size:
            part = self.socket.recv(1 << 16)
            if not part:
                raise ConnectionError("the server closed the socket")
            self.bytes += part
        out, self.bytes = self.bytes[:size], self.bytes[size:]
        return out

    def _part(self):
        first, second = self._take(2)
        size = second & 127
        if size == 126:
            size = struct.unpack(">H", self._take(2))[0]
        elif size == 127:
            size = struct.unpack(">Q", self._take(8))[0]
        assert not second & 128, "a server does not mask"
        return first & 128, first & 15, self._take(size)

    def receive(self):
        """Reads one message and stores it. Returns a JSON object, or the kind of a binary message."""
        final, code, data = self._part()
        while not final:
            final, _, more = self._part()
            data += more
        if code == 8:
            self.closed = struct.unpack(">H", data[:2])[0] if len(data) >= 2 else 1005
            raise ConnectionError(f"closed with {self.closed}")
        if code == 9:
            self._send(10, data)
            return self.receive()
        if code == 1:
            return self._text(json.loads(data))
        assert code == 2, code
        kind, length = struct.unpack_from("<II", data)
        assert length == len(data), (length, len(data))
        if kind == 1:
            self.geometry = data
        else:
            self.frames.append(self.read_frame(data))
        return kind

    def _text(self, message):
        if message["type"] == "scene":
            self.scene, self.geometry, self.frames = message, None, []
        elif message["type"] == "state":
            self.states.append(message)
        else:
            self.texts.append(message)
        return message

    def until(self, condition, seconds=30):
        """Receives until condition() is true."""
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise TimeoutError(f"no such message; last state {self.states[-1:]}, texts {self.texts}")
            self.receive()

    def listen(self, seconds):
        """Receives for so long."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.bytes or select.select([self.socket], [], [], max(0.0, end - time.monotonic()))[0]:
                self.receive()

    def _send(self, code, data):
        mask = os.urandom(4)
        size = len(data)
        head = bytes([128 | code]) + (bytes([128 | size]) if size < 126 else
                                      bytes([128 | 126]) + struct.pack(">H", size) if size < 1 << 16 else
                                      bytes([128 | 127]) + struct.pack(">Q", size))
        self.socket.sendall(head + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

    def send(self, **message):
        self._send(1, json.dumps(message).encode())

    def send_raw(self, data, code=1):
        self._send(code, data)

    def read_frame(self, data):
        """Returns a frame as a dictionary of tuples; of many bodies, positions are in one tuple each."""
        time_s, rows = struct.unpack_from("<dI", data, 8)
        at = 20
        out = {"time_s": time_s, "bodies": [], "tools": [], "bones": [], "hands": [], "rows": []}

        def floats(count):
            nonlocal at
            values = struct.unpack_from(f"<{count}f", data, at)
            at += 4 * count
            return values
        for body in self.scene["bodies"]:
            out["bodies"].append(floats(3 * body["nodes"]))
        out["tools"] = [floats(7) for _ in self.scene["tools"]]
        out["bones"] = [floats(7) for _ in self.scene["bones"]]
        for _ in self.scene["hands"]:
            values = floats(13)
            flags = struct.unpack_from("<I", data, at)[0]
            at += 4
            out["hands"].append({"pose": values[:7], "force": values[7:10], "torque": values[10:],
                                 "flags": flags})
        for _ in range(rows):
            out["rows"].append([floats(7) for _ in self.scene["hands"]])
        assert at == len(data), (at, len(data))
        return out


class Server:
    """A process of `palpate touch`."""

    def __init__(self, program, *arguments, cwd=None):
        self.process = subprocess.Popen([str(program), "touch", *arguments, "--no-browser"], cwd=cwd,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.lines = []
        self.port = self.token = None
        found = threading.Event()

        def read():
            for line in self.process.stdout:
                self.lines.append(line.rstrip())
                match = re.search(r"http://([\d.]+):(\d+)/\?token=([0-9a-f]{32})", line)
                if match:
                    self.port, self.token = int(match[2]), match[3]
                    found.set()
            found.set()
        self.thread = threading.Thread(target=read, daemon=True)
        self.thread.start()
        if not found.wait(60) or self.port is None:
            self.process.kill()
            raise RuntimeError("no address: " + "\n".join(self.lines))

    def viewer(self, **options):
        return Viewer(self.port, options.pop("token", self.token), **options)

    def get(self, path, headers=None):
        """Returns status, headers and body of a page."""
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", headers=headers or {})
        try:
            with urllib.request.urlopen(request, timeout=20) as reply:
                return reply.status, reply.headers, reply.read()
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()

    def stop(self):
        """Ctrl-C; returns the exit status."""
        if self.process.poll() is None:
            self.process.send_signal(2)
        status = self.process.wait(timeout=60)
        self.thread.join(timeout=5)
        return status

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()
