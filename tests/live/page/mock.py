#!/usr/bin/env python3
"""A stand-in of `palpate touch` that serves the page and speaks its protocol (docs/live.md), with a ball.

    mock.py [--large]      prints the address; for work on the page without the simulator
"""
import http
import itertools
import json
import socket
import struct
import sys
import threading
import time
from pathlib import Path

from ball import COUPLING_N_M, STIFFNESS_N_M, Ball, packed, sphere
from websocket import WebSocket, accept_line

SOURCE = Path(__file__).resolve().parents[3] / "src"
FILES = {"/": (SOURCE / "live/page/dist/viewer.html", "text/html; charset=utf-8"),
         "/viewer.js": (SOURCE / "live/page/dist/viewer.js", "text/javascript"),
         "/viewer.css": (SOURCE / "live/page/dist/viewer.css", "text/css"),
         "/three.js": (SOURCE / "report/page/dist/three.js", "text/javascript")}
POLICY = ("default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
          "connect-src 'self'")
GEOMETRY, FRAME, TOKEN = 1, 2, "mock"
TOOL_RADIUS_M, TICK_S = 0.012, 1e-3


class Scene:
    """One ball, one tool, one hand; what the viewers did to them. Further hands touch nothing."""

    def __init__(self, ball, free=False, hand=True, more_hands=(), live=(True, True)):
        self.ball, self.free, self.hand, self.live = ball, free, hand, live
        self.tool_shape = sphere(TOOL_RADIUS_M, 16, 32)
        self.start = [0.0, -1.5 * ball.radius, 0.0]
        self.poses = [[*at, 1.0, 0.0, 0.0, 0.0] for at in (self.start, *more_hands)]
        self.positions = None  # replaces the dent
        self.stiffness = COUPLING_N_M
        self.touch()

    @property
    def pose(self):
        return self.poses[0]

    def touch(self):
        nodes, depth, into = self.ball.dented(self.pose[:3], TOOL_RADIUS_M)
        self.nodes, self.depth = self.positions or nodes, depth
        self.force = [-STIFFNESS_N_M * depth * one for one in into]
        back = STIFFNESS_N_M * depth / COUPLING_N_M
        self.tool = [*(one - back * b for one, b in zip(self.pose[:3], into)), *self.pose[3:]]

    def description(self):
        vertices, triangles = self.tool_shape
        most = 1.7 * self.ball.radius
        out = {"type": "scene", "protocol": 1, "version": "mock", "scene": "ball", "tick_s": TICK_S,
                "scheme": "partitioned", "integrator": "none", "up": [0, 0, 1],
                "bounds": {"min": [-self.ball.radius, -most, -self.ball.radius],
                           "max": [self.ball.radius] * 3},
                "bodies": [self.ball.description(attached=not self.free)],
                "tools": [{"name": "tool", "hand": hand, "vertices": len(vertices),
                           "triangles": len(triangles), "colour": colour}
                          for hand, colour in zip(range(len(self.poses)), ("#2f6db3", "#2f9e63"))],
                "bones": [], "obstacles": [],
                "hands": [{"name": name, "live": live, "max_force_n": 3.3, "stiffness_n_m": 1000,
                           "workspace": {"center": [0, 0, 0], "radius": 3 * self.ball.radius}}
                          for _, name, live in zip(self.poses, ("hand", "second"), self.live)],
                "sliders": [{"key": "tool.coupling.stiffness_n_m", "label": "Coupling stiffness",
                             "unit": "N/m", "value": self.stiffness, "min": 10, "max": 3000,
                             "logarithmic": True}]}
        return out if self.hand else {**out, "hands": [], "tools": [], "sliders": [],
                                             "tick_s": 0.0}

    def geometry(self):
        vertices, triangles = self.tool_shape
        body = self.ball.geometry()
        if self.hand:
            body += len(self.poses) * (packed("f", itertools.chain.from_iterable(vertices)) +
                                       packed("I", itertools.chain.from_iterable(triangles)))
        return struct.pack("<II", GEOMETRY, 8 + len(body)) + body

    def frame(self, time_s, since_s):
        samples = max(1, min(20, int(200 * (time_s - since_s))))
        wrench = [*self.force, 0.0, 0.0, 1e-3 * self.depth]
        strip = b""
        for s in range(samples):
            before = -(samples - 1 - s) / 200
            strip += packed("f", [before, *wrench, *([before, *6 * [0.0]] * (len(self.poses) - 1))])
        body = (struct.pack("<dI", time_s, samples) +
                packed("f", itertools.chain.from_iterable(self.nodes)))
        if self.hand:
            more = self.poses[1:]
            body += packed("f", itertools.chain(self.tool, *more))
            body += packed("f", [*self.pose, *wrench]) + struct.pack("<I", 1 | (4 if self.depth > 0 else 0))
            body += b"".join(packed("f", [*pose, *6 * [0.0]]) + struct.pack("<I", 1) for pose in more)
            body += strip
        return struct.pack("<II", FRAME, 8 + len(body)) + body


class Mock:
    """Serves on a free port of the loopback interface, in threads. `received`: messages of all viewers."""

    def __init__(self, scene=None, frames_per_s=60.0):
        self.scene = scene or Scene(Ball())
        self.period_s = 1 / frames_per_s
        self.received, self.viewers, self.holder = [], [], None
        self.running, self.recording, self.began = True, None, time.monotonic()
        self.extra = {}  # overrides of the state message
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.address = f"http://127.0.0.1:{self.port}/?token={TOKEN}"
        threading.Thread(target=self._accept, daemon=True).start()

    def close(self, code=1001):
        """Ends like the program does: the viewers are told, and nobody answers any more."""
        try:
            self.listener.shutdown(socket.SHUT_RDWR)  # wakes the thread that accepts
        except OSError:
            pass  # closed before
        self.listener.close()
        self.drop_viewers(code)

    def drop_viewers(self, code):
        for viewer in list(self.viewers):
            try:
                viewer.close(code)
                viewer.connection.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass  # it left by itself

    def now(self):
        return time.monotonic() - self.began

    def tell(self, message):
        for viewer in list(self.viewers):
            viewer.send_text(json.dumps(message))

    def _accept(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection):
        with connection.makefile("rb", buffering=0) as lines:  # nothing of the WebSocket may be read here
            words, headers = lines.readline().split(b" "), {}
            if len(words) < 2:
                return connection.close()
            while (line := lines.readline().strip()):
                name, _, value = line.decode().partition(":")
                headers[name.lower()] = value.strip()
        path, _, query = words[1].decode().partition("?")
        allowed = query.split("&")[0] == f"token={TOKEN}"
        if path == "/socket" and allowed:
            connection.sendall(("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                                "Connection: Upgrade\r\nSec-WebSocket-Protocol: palpate-touch-1\r\n"
                                f"Sec-WebSocket-Accept: {accept_line(headers['sec-websocket-key'])}"
                                "\r\n\r\n").encode())
            return self._attend(WebSocket(connection))
        if path == "/scenes" and allowed:
            return self._answer(connection, 200, "application/json", json.dumps(
                [{"name": "ball", "summary": "a ball of this stand-in", "picture": None},
                 {"name": "other", "summary": "another scene", "picture": None}]).encode())
        if path in FILES and (allowed or path != "/"):
            return self._answer(connection, 200, FILES[path][1], FILES[path][0].read_bytes())
        return self._answer(connection, 404 if allowed else 403, "text/plain", b"no\n")

    @staticmethod
    def _answer(connection, status, kind, body):
        head = (f"HTTP/1.1 {status} {http.HTTPStatus(status).phrase}\r\nContent-Type: {kind}\r\n"
                f"Content-Length: {len(body)}\r\nContent-Security-Policy: {POLICY}\r\n"
                "Cache-Control: no-store\r\nConnection: close\r\n\r\n")
        connection.sendall(head.encode() + body)
        connection.close()

    def state(self, viewer):
        holder = "nobody" if self.holder is None else "you" if self.holder is viewer else "other"
        return {"type": "state", "time_s": self.now(), "running": self.running, "rate_hz": 1 / TICK_S,
                "late_share": 0.0, "skipped_ticks": 0, "late_p99_s": 6e-5, "work_p50_s": 3e-5,
                "work_p99_s": 8e-5, "energy_j": 0.5 * STIFFNESS_N_M * self.scene.depth ** 2,
                "passivity": {"observed": True, "energy_j": 1e-3}, "holder": holder,
                "viewers": len(self.viewers), "recording": self.recording, "message": None, **self.extra}

    def _attend(self, viewer):
        viewer.lock = threading.Lock()
        plain = viewer._send

        def locked(opcode, payload):
            with viewer.lock:
                plain(opcode, payload)

        viewer._send = locked
        self.viewers.append(viewer)
        threading.Thread(target=self._feed, args=(viewer,), daemon=True).start()
        try:
            while (text := viewer.receive()) is not None:
                self._obey(viewer, json.loads(text))
        except OSError:
            pass
        self.viewers.remove(viewer)
        if self.holder is viewer:
            self.holder = None
        viewer.file.close()
        viewer.connection.close()

    def _feed(self, viewer):
        scene, last, next_state = None, self.now(), 0.0
        try:
            while viewer in self.viewers:
                if scene is not self.scene:
                    scene = self.scene
                    viewer.send_text(json.dumps(scene.description()))
                    viewer.send_binary(scene.geometry())
                if time.monotonic() > next_state:
                    next_state = time.monotonic() + 0.1
                    viewer.send_text(json.dumps(self.state(viewer)))
                now = self.now()
                if self.running:
                    viewer.send_binary(scene.frame(now, last))
                last = now
                time.sleep(self.period_s)
        except OSError:
            pass

    def _obey(self, viewer, message):
        self.received.append(message)
        kind = message["type"]
        if kind == "take" and self.holder is None:
            self.holder = viewer
        elif kind == "drop" and self.holder is viewer:
            self.holder = None
        elif kind == "handle" and self.holder is viewer:
            self.scene.poses[message["hand"]] = [*message["position"], *message["rotation"]]
            self.scene.touch()
        elif kind == "pause":
            self.running = not message["on"]
        elif kind == "record":
            if not message["on"] and self.recording:
                self.tell({"type": "recorded", "folder": self.recording["folder"], "duration_s": 1.0,
                           "replay": f"palpate replay {self.recording['folder']}"})
            self.recording = {"folder": "out/ball", "since_s": 0.0} if message["on"] else None
        elif kind == "set":
            self.scene.stiffness = message["value"]
        elif kind == "reset":
            self.scene.pose[:3] = self.scene.start
            self.scene.touch()
            self.began = time.monotonic()
        if kind != "handle":
            viewer.send_text(json.dumps(self.state(viewer)))


if __name__ == "__main__":
    shape = Ball(cells=12, rings=142, sectors=284) if "--large" in sys.argv else Ball()
    print(Mock(Scene(shape)).address, flush=True)
    threading.Event().wait()
