"""A device on the network: sends poses to a running palpate, and receives the forces on the hand.

    python3 -m palpate.device 4711 poses.csv

moves the handle of a run with `[device] type = "udp"` and `port = 4711` along the recorded poses, and prints
the force ten times per second.  poses.csv has the columns time_s, px_m, py_m, pz_m and, optionally, qw, qx,
qy, qz; force.csv of an earlier run is one, too.  In a program of one's own:

    from palpate.device import Peer
    with Peer(4711) as peer:
        peer.send(position=(0, 0, 0.06))
        force, torque = peer.receive(wait_s=0.01)

Only Python's standard library is used.  docs/devices.md describes the packets.
"""
from __future__ import annotations

import argparse
import bisect
import csv
import math
import socket
import struct
import sys
import time
from collections.abc import Sequence
from typing import NamedTuple

MAGIC, VERSION, POSE, WRENCH = 0x54504C50, 1, 1, 2
_POSE = struct.Struct("<IHHQd3d4d3d3dI")
_WRENCH = struct.Struct("<IHHQd3d3d")


class Received(NamedTuple):
    """Wrench on the hand."""

    force: tuple[float, float, float]  #: [N]
    torque: tuple[float, float, float]  #: about the handle's origin [N m]
    time: float  #: simulated time of the tick [s]


def _quaternion(vector: Sequence[float]) -> list[float]:
    """Returns the unit quaternion w, x, y, z of a rotation vector [rad]."""
    angle = math.hypot(*vector)
    factor = math.sin(0.5 * angle) / angle if angle > 0.0 else 0.0
    return [math.cos(0.5 * angle), *(factor * one for one in vector)]


class Peer:
    """Sends poses of a handle to a UDP port of palpate, and receives one wrench per tick."""

    def __init__(self, port: int, address: str = "127.0.0.1") -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect((address, port))
        self._last: Received | None = None
        self.sent = 0  #: packets sent
        self.received = 0  #: wrenches received

    def __enter__(self) -> Peer:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def send(self, position: Sequence[float], rotation: Sequence[float] = (1.0, 0.0, 0.0, 0.0),
             velocity: Sequence[float] = (0.0, 0.0, 0.0), angular_velocity: Sequence[float] = (0.0, 0.0, 0.0),
             switches: int = 0) -> None:
        """Sends one pose: position [m], rotation as unit quaternion w, x, y, z, velocities [m/s, rad/s]."""
        # Sequence numbers rise from run to run of a peer: the clock in nanoseconds, as far as packets are
        # less than a second apart.
        self.sent += 1
        packet = _POSE.pack(MAGIC, VERSION, POSE, time.monotonic_ns(), time.monotonic(), *position, *rotation,
                            *velocity, *angular_velocity, switches)
        try:
            self._socket.send(packet)
        except ConnectionRefusedError:  # no run listens at that port yet, or no longer
            pass

    def receive(self, wait_s: float = 0.0) -> Received | None:
        """Returns the newest wrench, waiting for one for up to wait_s [s]; None before the first."""
        self._socket.settimeout(wait_s)  # 0: does not block
        try:
            while True:
                packet = self._socket.recv(256)
                self._socket.settimeout(0.0)
                if len(packet) != _WRENCH.size:
                    continue
                magic, version, kind, _, at, *numbers = _WRENCH.unpack(packet)
                if (magic, version, kind) == (MAGIC, VERSION, WRENCH):
                    self.received += 1
                    self._last = Received(tuple(numbers[:3]), tuple(numbers[3:]), at)
        except (TimeoutError, socket.timeout, BlockingIOError, ConnectionRefusedError):
            return self._last


class Poses:
    """Recorded poses with times: linear between two rows, at rest before the first and after the last."""

    def __init__(self, rows: Sequence[Sequence[float]]) -> None:
        """rows: time [s], position [m], unit quaternion w, x, y, z; times rise."""
        if not rows:
            raise ValueError("there are no poses")
        self._rows = [tuple(map(float, row)) for row in rows]
        self._times = [row[0] for row in self._rows]
        if any(later <= earlier for earlier, later in zip(self._times, self._times[1:])):
            raise ValueError("times must rise from row to row")

    @classmethod
    def read(cls, path: str) -> Poses:
        """Reads a CSV file; raises ValueError for one without the columns."""
        with open(path, newline="", encoding="utf-8-sig") as file:
            lines = csv.DictReader(file)
            names = lines.fieldnames = [name.strip() for name in lines.fieldnames or ()]
            recorded = "px_m" not in names and "handle_x_m" in names  # force.csv of a run
            position = [f"handle_{axis}_m" if recorded else f"p{axis}_m" for axis in "xyz"]
            turn = [f"handle_rotation_{axis}_rad" for axis in "xyz"] if recorded else ["qw", "qx", "qy", "qz"]
            missing = [name for name in ("time_s", *position) if name not in names]
            if missing:
                raise ValueError(f"{path}: column {missing[0]} is missing (columns: {', '.join(names)})")
            rows = []
            for line in lines:
                turned = [float(line[name]) for name in turn if name in names]
                rotation = turned if len(turned) == 4 else _quaternion(turned or [0.0, 0.0, 0.0])
                rows.append([float(line["time_s"]), *(float(line[name]) for name in position), *rotation])
        return cls(rows)

    @property
    def duration(self) -> float:
        """Time of the last pose [s]."""
        return self._times[-1]

    def at(self, t: float) -> tuple[list[float], list[float], list[float]]:
        """Returns position [m], rotation and velocity [m/s] at time t [s]."""
        i = bisect.bisect_right(self._times, t)
        if i == 0 or i == len(self._rows):
            row = self._rows[max(i - 1, 0)]
            return list(row[1:4]), list(row[4:8]), [0.0, 0.0, 0.0]
        before, after = self._rows[i - 1], self._rows[i]
        span = after[0] - before[0]
        x = (t - before[0]) / span
        mixed = [a + x * (b - a) for a, b in zip(before[1:4], after[1:4])]
        sign = 1.0 if sum(a * b for a, b in zip(before[4:8], after[4:8])) >= 0.0 else -1.0
        turned = [a + x * (sign * b - a) for a, b in zip(before[4:8], after[4:8])]
        norm = math.sqrt(sum(one * one for one in turned))
        velocity = [(b - a) / span for a, b in zip(before[1:4], after[1:4])]
        return mixed, [one / norm for one in turned], velocity


def play(peer: Peer, poses: Poses, *, rate: float = 1000.0, wait_s: float = 30.0,
         every_s: float = 0.1) -> float:
    """Holds the first pose until a run answers, moves the handle along the poses, and prints the force.

    Returns the largest force [N].  Raises TimeoutError if no run answers within wait_s [s].
    """
    start = time.monotonic()
    position, rotation, velocity = poses.at(-math.inf)
    while peer.receive(wait_s=1.0 / rate) is None:
        if time.monotonic() - start > wait_s:
            raise TimeoutError(f"no run answered within {wait_s:g} s; start it with --realtime, and check "
                               "its port and address")
        peer.send(position, rotation, velocity)
    first = time.monotonic()
    largest, printed = 0.0, -math.inf
    for tick in range(round(poses.duration * rate) + 1):
        t = tick / rate
        time.sleep(max(0.0, first + t - time.monotonic()))
        position, rotation, velocity = poses.at(t)
        peer.send(position, rotation, velocity)
        wrench = peer.receive()
        size = math.hypot(*wrench.force)
        largest = max(largest, size)
        if t - printed >= every_s - 0.5 / rate:
            print(f"{t:7.2f} s  force {wrench.force[0]:8.3f} {wrench.force[1]:8.3f} {wrench.force[2]:8.3f} N",
                  flush=True)
            printed = t
    return largest


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python3 -m palpate.device", description=(
        "Moves the handle of a run with [device] type = \"udp\" along recorded poses, and prints the force."))
    parser.add_argument("port", type=int, help="device.port of the scene")
    parser.add_argument("poses", help="CSV file: time_s, px_m, py_m, pz_m and optionally qw, qx, qy, qz")
    parser.add_argument("--address", default="127.0.0.1", help="machine of the run (default: this one)")
    parser.add_argument("--rate", type=float, default=1000.0, help="poses per second (default: 1000)")
    parser.add_argument("--wait-s", type=float, default=30.0, help="longest wait for the run (default: 30)")
    options = parser.parse_args(arguments)
    try:
        poses = Poses.read(options.poses)
        with Peer(options.port, options.address) as peer:
            largest = play(peer, poses, rate=options.rate, wait_s=options.wait_s)
            print(f"largest force {largest:.3f} N; {peer.sent} poses sent, {peer.received} wrenches received")
    except (OSError, ValueError) as error:
        print(f"palpate.device: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
