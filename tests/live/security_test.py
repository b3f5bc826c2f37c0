#!/usr/bin/env python3
"""Who may connect to `palpate touch`, and what it does with other messages."""
import socket
import subprocess
import sys
import tempfile
import shutil
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from touch_client import Refused, Server

PROGRAM = Path(sys.argv.pop(1)).resolve()


class Security(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="palpate-touch-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.server = Server(PROGRAM, "falling-ball", cwd=cls.folder)
        cls.addClassCleanup(cls.server.stop)

    def refused(self, **options):
        with self.assertRaises(Refused) as caught:
            self.server.viewer(**options).close()
        return caught.exception.status

    def test_only_the_page_of_this_server_connects(self):
        port = self.server.port
        viewer = self.server.viewer(host=f"localhost:{port}")
        viewer.until(lambda: viewer.scene is not None, 60)
        viewer.close()
        forwarded = self.server.viewer(host="localhost:9")  # ssh -L 9:...
        forwarded.close()
        for options in ({"token": "0" * 32}, {"token": ""}, {"token": self.server.token[:-1]},
                        {"token": self.server.token + "0"}, {"origin": "http://evil.example"},
                        {"origin": "null"}, {"origin": ""}, {"origin": f"http://localhost:{port}"},
                        {"host": "evil.example"}, {"protocol": None}, {"protocol": "other"}):
            self.assertEqual(self.refused(**options), 403, options)

    def test_pages_need_the_token_and_say_nothing_without(self):
        token = self.server.token
        for path in ("/", "/scenes", "/picture/press-ball.png", "/?token=" + "0" * 32, "/scenes?token="):
            status, _, body = self.server.get(path)
            self.assertEqual(status, 403, path)
            self.assertNotIn(b"falling", body)
            self.assertNotIn(token.encode(), body)
        self.assertEqual(self.server.get(f"/?token={token}")[0], 200)
        self.assertEqual(self.server.get(f"/?token={token}", {"Host": "evil.example"})[0], 403)
        for path in ("/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/picture/..%2f..%2fetc%2fpasswd"):
            self.assertIn(self.server.get(f"{path}?token={token}")[0], (403, 404), path)

    def test_headers_keep_foreign_content_out(self):
        headers = self.server.get(f"/?token={self.server.token}")[1]
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
        self.assertEqual(headers["Referrer-Policy"], "no-referrer")
        self.assertEqual(headers["Cache-Control"], "no-store")
        self.assertIsNone(headers["Access-Control-Allow-Origin"])

    def test_it_listens_on_loopback_only(self):
        with open("/proc/net/tcp", encoding="utf-8") as table:
            listening = [line.split()[1] for line in table if line.split()[3] == "0A"]
        own = [address for address in listening if address.endswith(f":{self.server.port:04X}")]
        self.assertEqual([address.split(":")[0] for address in own], ["0100007F"])

    def test_a_port_in_use_and_a_foreign_address_are_errors_of_one_line(self):
        for arguments, part in ((["--port", str(self.server.port)], "Address already in use"),
                                (["--address", "192.0.2.1"], "is no address of this machine"),
                                (["--address", "localhost"], "is not an IPv4 address")):
            done = subprocess.run([str(PROGRAM), "touch", "falling-ball", "--no-browser", *arguments],
                                  capture_output=True, text=True, timeout=60, cwd=self.folder)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertTrue(done.stderr.startswith("palpate: error: --"), done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn(part, done.stderr)

    def test_bad_messages_end_a_viewer_and_no_other(self):
        good, bad = self.server.viewer(), self.server.viewer()
        self.addCleanup(good.close)
        sent = [b"x", b"{}", b"[" * 1000, b'{"type":"take","x":1}', b"\xff\xfe", b"a" * 1025, b"b" * 60000]
        for i in range(19):
            bad.send_raw(sent[i % len(sent)] if sent[i % len(sent)] != b"\xff\xfe" else b"{\"type\":1}")
        bad.listen(0.3)
        bad.send_raw(b"last", code=2)  # binary
        with self.assertRaises(ConnectionError):
            bad.listen(10)
        self.assertEqual(bad.closed, 1008)
        good.until(lambda: len(good.frames) >= 2, 60)

    def test_the_ninth_viewer_is_refused(self):
        viewers = []
        self.addCleanup(lambda: [viewer.close() for viewer in viewers])
        while len(viewers) < 20:
            try:
                viewers.append(self.server.viewer())
            except Refused as refusal:
                self.assertEqual(refusal.status, 503)
                break
        self.assertLessEqual(len(viewers), 8)
        self.assertGreater(len(viewers), 5)  # connections of other tests may not have ended yet

    def test_many_idle_connections_do_not_end_the_server(self):
        sockets = []
        for _ in range(200):
            try:
                sockets.append(socket.create_connection(("127.0.0.1", self.server.port), timeout=1))
            except OSError:
                break
        for one in sockets:
            one.close()
        viewer = self.server.viewer()
        viewer.until(lambda: len(viewer.frames) >= 2, 60)
        viewer.close()


if __name__ == "__main__":
    unittest.main()
