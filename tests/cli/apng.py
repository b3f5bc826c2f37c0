"""Reads PNG files and animated ones (PNG, third edition) with zlib only: independent of palpate's writer.
Anything that the standard forbids is a ValueError."""
import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"
CHANNELS = {2: 3, 6: 4}  # RGB, RGBA, 8 bits each


def need(condition, message):
    if not condition:
        raise ValueError(message)


def chunks(data):
    """Yields (type, data) of each chunk, after checking its CRC."""
    need(data.startswith(SIGNATURE), "no PNG")
    at = len(SIGNATURE)
    while at < len(data):
        length, = struct.unpack(">I", data[at:at + 4])
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + length]
        need(len(body) == length, "ends inside a chunk")
        crc, = struct.unpack(">I", data[at + 8 + length:at + 12 + length])
        need(crc == zlib.crc32(kind + body), f"CRC of {kind}")
        yield kind.decode(), body
        at += 12 + length


def unfiltered(data, width, height, channels):
    """Returns the rows of bytes without their filters."""
    raw, row_bytes = zlib.decompress(data), width * channels
    need(len(raw) == height * (row_bytes + 1), f"{len(raw)} bytes of pixels")
    rows, above = [], bytearray(row_bytes)
    for y in range(height):
        kind = raw[y * (row_bytes + 1)]
        row = bytearray(raw[y * (row_bytes + 1) + 1:(y + 1) * (row_bytes + 1)])
        need(kind <= 4, f"filter {kind}")
        for i in range(row_bytes) if kind else ():
            left = row[i - channels] if i >= channels else 0
            corner = above[i - channels] if i >= channels else 0
            up = above[i]
            if kind == 1:
                guess = left
            elif kind == 2:
                guess = up
            elif kind == 3:
                guess = (left + up) // 2
            else:
                guess = min((abs(up - corner), 0, left), (abs(left - corner), 1, up),
                            (abs(left + up - 2 * corner), 2, corner))[2]
            row[i] = (row[i] + guess) & 255
        rows.append(bytes(row))
        above = row
    return rows


class Animation:
    """width, height; delays: [s] per frame; frames: each a list of rows of (r, g, b) as bytes, composed over
    the previous frames. A PNG without animation has one frame, and no delays."""

    def __init__(self, path):
        self.delays, self.frames, self.canvas = [], [], None
        self.control, self.pixels, self.numbers = None, b"", []
        kinds, announced = [], None
        for kind, body in chunks(path.read_bytes()):
            kinds.append(kind)
            if kind == "IHDR":
                self.width, self.height, bits, self.colour, *rest = struct.unpack(">IIBBBBB", body)
                need((bits, rest) == (8, [0, 0, 0]), "not of 8 bits, deflate, plain")
                self.control = (self.width, self.height, 0, 0, 0, 0)
            elif kind == "acTL":
                need("IDAT" not in kinds, "acTL behind IDAT")
                announced, plays = struct.unpack(">II", body)
                need(plays == 0, "plays for ever")
            elif kind == "fcTL":
                self.show()
                number, *self.control, up, down, dispose, blend = struct.unpack(">IIIIIHHBB", body)
                need(dispose == 0, "dispose: none")
                self.control += [dispose, blend]
                self.numbers.append(number)
                self.delays.append(up / down)
            elif kind == "IDAT":
                self.pixels += body
            elif kind == "fdAT":
                self.numbers.append(struct.unpack(">I", body[:4])[0])
                self.pixels += body[4:]
        self.show()
        need(kinds[0] == "IHDR" and kinds[-1] == "IEND", "begins with IHDR, ends with IEND")
        if announced is not None:
            need(announced == len(self.frames), f"{announced} frames announced, {len(self.frames)} there")
        need(self.numbers == list(range(len(self.numbers))), "sequence numbers")

    def show(self):
        """Composes the frame whose data has been read."""
        if not self.pixels:
            return
        width, height, left, top, _, blend = self.control
        need(left + width <= self.width and top + height <= self.height, "a frame beyond the canvas")
        channels = CHANNELS[self.colour]
        rows = unfiltered(self.pixels, width, height, channels)
        if self.canvas is None:
            need((width, height, left, top) == (self.width, self.height, 0, 0), "the first frame is whole")
            self.canvas = [bytearray(3 * self.width) for _ in range(self.height)]
        for y, row in enumerate(rows):
            for x in range(width):
                pixel = row[channels * x:channels * (x + 1)]
                if channels == 4 and pixel[3] == 0 and blend == 1:
                    continue
                need(channels == 3 or pixel[3] == 255, "a pixel half transparent")
                self.canvas[top + y][3 * (left + x):3 * (left + x) + 3] = pixel[:3]
        self.frames.append([bytes(row) for row in self.canvas])
        self.pixels = b""
