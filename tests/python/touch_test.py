#!/usr/bin/env python3
"""palpate.touch: a scene in a cell of a notebook, in a headless Chromium where there is one."""
import functools
import http.server
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path

from built import PACKAGE, PROGRAM, SCENES, TREE
import palpate
from palpate.device import Peer

sys.path[:0] = [str(TREE / "tests/cli"), str(TREE / "tests/live")]
import browser  # noqa: E402
from touch_client import Viewer  # noqa: E402

if not (PROGRAM.parent / "palpate-touch").is_file():
    print("SKIPPED: built without PALPATE_WITH_LIVE")
    sys.exit(77)


def viewer_of(view):
    """Returns a viewer that has received the scene and a frame."""
    address = urllib.parse.urlparse(view.address)
    out = Viewer(address.port, urllib.parse.parse_qs(address.query)["token"][0])
    out.until(lambda: out.frames, 60)
    return out


class Pages:
    """A server of one page, such as that of a notebook, at an address of the loopback interface."""

    def __init__(self, text, host):
        self.folder = tempfile.TemporaryDirectory()
        (Path(self.folder.name) / "cell.html").write_text(f"<!doctype html>{text}")
        quiet = type("Quiet", (http.server.SimpleHTTPRequestHandler,), {"log_message": lambda *_: None})
        self.server = http.server.ThreadingHTTPServer(
            (host, 0), functools.partial(quiet, directory=self.folder.name))
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.address = f"http://{host}:{self.server.server_port}/cell.html"

    def close(self):
        self.server.shutdown()
        self.server.server_close()
        self.folder.cleanup()


class Touch(unittest.TestCase):
    def touch(self, *arguments, **options):
        view = palpate.touch(*arguments, **options)
        self.addCleanup(view.stop)
        return view

    def watch(self, view):
        viewer = viewer_of(view)
        self.addCleanup(viewer.close)
        return viewer

    def test_the_page_is_served_until_stop(self):
        view = self.touch("press-ball", height_px=500)
        self.assertTrue(view.running)
        with urllib.request.urlopen(view.address, timeout=20) as reply:
            self.assertIn("palpate touch", reply.read().decode())
        self.assertIn(f'<iframe src="{view.address}"', view._repr_html_())
        self.assertIn("height: 500px", view._repr_html_())
        self.assertIn(view.address, repr(view))
        start = time.monotonic()
        view.stop()
        view.stop()
        self.assertLess(time.monotonic() - start, 30)
        self.assertFalse(view.running)
        self.assertNotIn("iframe", view._repr_html_())
        self.assertIn("has ended", repr(view))
        with self.assertRaises(urllib.error.URLError):
            urllib.request.urlopen(view.address, timeout=20)

    def test_scenes_with_changes_and_scenes_without_a_file(self):
        scene = palpate.load(SCENES / "press-ball.toml")
        scene.set("body.0.youngs_modulus_pa", 4e4)
        sliders = {one["key"]: one["value"] for one in self.watch(self.touch(scene)).scene["sliders"]}
        self.assertEqual(sliders["body.0.youngs_modulus_pa"], 4e4)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "meshes").symlink_to(SCENES / "meshes")
            mesh = next((SCENES / "meshes").glob("*.msh"))
            body = {"name": "one", "youngs_modulus_pa": 1e4, "poissons_ratio": 0.4, "density_kg_m3": 1e3,
                    "mesh": {"file": f"meshes/{mesh.name}", "scale": 1e-3}}
            made = palpate.Scene({"scene": {"name": "a mesh", "duration_s": 0.1}, "body": [body]}, folder)
            with palpate.touch(made) as view:
                self.assertEqual(self.watch(view).scene["bodies"][0]["name"], "one")
                self.assertEqual([one.name[:7] for one in Path(folder).glob("*.toml")], ["a-mesh-"])
            self.assertEqual(list(Path(folder).glob("*.toml")), [])

    def test_errors_are_those_of_the_program(self):
        occupied = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(occupied.close)
        for arguments, options, message in [
                (["no-such-scene"], {}, "no-such-scene"),
                (["press-ball"], {"scheme": "monolithic"}, "monolithic"),
                (["press-ball"], {"port": occupied.getsockname()[1]}, "cannot listen on 127.0.0.1")]:
            with self.subTest(arguments, **options):
                with self.assertRaises(palpate.Error) as caught:
                    palpate.touch(*arguments, **options)
                self.assertIn(message, str(caught.exception))
                self.assertNotIn("palpate: error", str(caught.exception))

    def test_a_scene_that_cannot_be_assembled_says_why(self):
        scene = palpate.load(SCENES / "user-mesh.toml")
        scene.set("body.0.mesh.scale", 1.0)  # of millimetres: everything is elsewhere
        view = self.touch(scene)
        until = time.monotonic() + 60
        while view.running:
            self.assertLess(time.monotonic(), until)
            time.sleep(0.1)
        self.assertIn("enlarge the box", view.error)
        self.assertIn("enlarge the box", repr(view))
        self.assertIn("enlarge the box", view._repr_html_())
        self.assertNotIn("palpate: error", view.error)

    def with_program(self, path):
        self.addCleanup(os.environ.pop, "PALPATE_PROGRAM", None)
        os.environ["PALPATE_PROGRAM"] = str(path)

    def test_a_program_without_its_server_says_how_to_build_it(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy2(PROGRAM, folder)
            self.with_program(Path(folder) / PROGRAM.name)
            with self.assertRaisesRegex(palpate.Error, "PALPATE_WITH_LIVE=ON.*libwebsockets-dev"):
                palpate.touch("press-ball")
            self.with_program(Path(folder) / "absent")
            with self.assertRaisesRegex(palpate.Error, "touch: the program palpate is missing"):
                palpate.touch("press-ball")

    def test_it_ends_with_python(self):
        code = ("import palpate, time; view = palpate.touch('press-ball'); print(view.address, flush=True); "
                "time.sleep(60)")
        with subprocess.Popen([sys.executable, "-B", "-c", code], stdout=subprocess.PIPE, text=True,
                              env={**os.environ, "PYTHONPATH": str(PACKAGE)}) as python:
            port = urllib.parse.urlparse(python.stdout.readline()).port
            socket.create_connection(("127.0.0.1", port), timeout=20).close()
            python.send_signal(signal.SIGKILL)
        until = time.monotonic() + 30
        with self.assertRaises(ConnectionRefusedError):
            while time.monotonic() < until:
                socket.create_connection(("127.0.0.1", port), timeout=20).close()
                time.sleep(0.1)

    def test_python_moves_one_hand_and_the_page_the_other(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        scene = palpate.load(SCENES / "two-hands.toml")
        scene.set_all({"hand.0.device.type": "udp", "hand.0.device.port": port})
        view = self.touch(scene)
        ended, forces = threading.Event(), []

        def move():
            with Peer(port) as peer:
                start = time.monotonic()
                while not ended.is_set():
                    pressed = min(0.015, 0.01 * max(0.0, time.monotonic() - start - 1.0))
                    peer.send((-0.051 + pressed, 0.0, 0.03))
                    if (got := peer.receive(wait_s=2e-3)) is not None:
                        forces.append(got.force)
        thread = threading.Thread(target=move)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(ended.set)
        viewer = self.watch(view)
        self.assertEqual([one["live"] for one in viewer.scene["hands"]], [True, False])
        viewer.send(type="take")
        for i in range(1, 101):
            viewer.send(type="handle", hand=0, position=[0.051 - 1.5e-4 * i, 0.0, 0.03],
                        rotation=[1, 0, 0, 0])
            viewer.send(type="handle", hand=1, position=[0.0, 0.0, 0.5], rotation=[1, 0, 0, 0])  # not its own
            viewer.listen(0.01)

        def pressed():  # both handles have arrived, and the tools have followed them
            first, second = viewer.frames[-1]["hands"]
            return second["pose"][0] > -0.0365 and first["force"][0] > 0.2 > -0.2 > second["force"][0]
        viewer.until(pressed, 30)
        first, second = viewer.frames[-1]["hands"]
        self.assertAlmostEqual(first["pose"][0], 0.036, delta=1e-3)
        self.assertAlmostEqual(second["pose"][2], 0.03, delta=1e-6)
        self.assertLess(forces[-1][0], -0.2, "Python receives the force on its hand")


@unittest.skipUnless(browser.program(), "no Chromium here (Debian package chromium)")
class Cell(unittest.TestCase):
    def setUp(self):
        self.view = palpate.touch("press-ball")
        self.addCleanup(self.view.stop)
        self.viewer = viewer_of(self.view)
        self.addCleanup(self.viewer.close)
        self.tab = browser.Browser()
        self.addCleanup(self.tab.close)

    def viewers(self):
        self.viewer.listen(0.3)
        return self.viewer.states[-1]["viewers"]

    def pages(self, host):
        pages = Pages(self.view._repr_html_(), host)
        self.addCleanup(pages.close)
        return pages.address

    def test_a_page_of_this_machine_shows_it_in_a_frame(self):
        for host in ("127.0.0.1", "localhost"):
            with self.subTest(host):
                self.tab.open(self.pages(host))
                until = time.monotonic() + 60
                while self.viewers() < 2:
                    self.assertLess(time.monotonic(), until, self.tab.errors)
                self.assertEqual(self.tab.errors, [])
                self.tab.call("Page.navigate", url="about:blank")
                while self.viewers() > 1:
                    self.assertLess(time.monotonic(), until + 60)

    def test_other_pages_may_not(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "cell.html"
            file.write_text(f"<!doctype html>{self.view._repr_html_()}")
            for place in (self.pages("127.0.0.2"), file):
                with self.subTest(str(place)):
                    self.tab.open(place)
                    until = time.monotonic() + 60
                    while not any("frame-ancestors" in one for one in self.tab.errors):
                        self.assertLess(time.monotonic(), until, self.tab.errors)
                        self.tab.value("1")
                        time.sleep(0.1)
                    self.assertEqual(self.viewers(), 1)


if __name__ == "__main__":
    unittest.main(argv=[__file__])
