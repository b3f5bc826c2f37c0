"""The server's end of a WebSocket (RFC 6455), as far as the tests of the page need it."""
import base64
import hashlib
import struct

MAGIC = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10


def accept_line(key):
    return base64.b64encode(hashlib.sha1((key + MAGIC).encode()).digest()).decode()


class WebSocket:
    """Frames over a connected socket, after the handshake."""

    def __init__(self, connection):
        self.connection = connection
        self.file = connection.makefile("rb")

    def _send(self, opcode, payload):
        size = len(payload)
        if size < 126:
            head = struct.pack("!BB", 0x80 | opcode, size)
        elif size < 1 << 16:
            head = struct.pack("!BBH", 0x80 | opcode, 126, size)
        else:
            head = struct.pack("!BBQ", 0x80 | opcode, 127, size)
        self.connection.sendall(head + payload)

    def send_text(self, text):
        self._send(TEXT, text.encode())

    def send_binary(self, payload):
        self._send(BINARY, payload)

    def close(self, code):
        self._send(CLOSE, struct.pack("!H", code))

    def receive(self):
        """Returns the next text, or None at the end."""
        while True:
            head = self.file.read(2)
            if len(head) < 2:
                return None
            opcode, size = head[0] & 15, head[1] & 127
            if size == 126:
                size, = struct.unpack("!H", self.file.read(2))
            elif size == 127:
                size, = struct.unpack("!Q", self.file.read(8))
            mask = self.file.read(4)
            payload = bytes(one ^ mask[i % 4] for i, one in enumerate(self.file.read(size)))
            if opcode == CLOSE:
                return None
            if opcode == PING:
                self._send(PONG, payload)
            elif opcode == TEXT:
                return payload.decode()
