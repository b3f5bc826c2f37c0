"""`palpate.touch`: a scene in a cell of a notebook or in a browser, served by `palpate touch`."""
from __future__ import annotations

import collections
import html
import os
import re
import signal
import subprocess
import tempfile
import threading
import weakref
from pathlib import Path

from ._palpate import Error, Scene
from ._program import error_of, program

ADDRESS = re.compile(r"http://[\d.]+:\d+/\?token=[0-9a-f]+")
PATIENCE_S = 60.0  # for a recording to be completed


class Touch:
    """A scene that runs in real time in a separate process, and its page.

    In a notebook, a cell whose last value this is shows the page.  The process ends by stop(), with this
    object, and with Python.
    """

    def __init__(self, process: subprocess.Popen[str], address: str, file: str, height_px: int) -> None:
        self.address = address  #: address of the page, with its token: whoever has it can use the page
        self.height_px = height_px  #: height of the page in a cell
        self.messages: collections.deque[str] = collections.deque(maxlen=200)  #: last lines of the program
        self._process = process
        self._reading = threading.Thread(target=_read, args=(process, self.messages), daemon=True)
        self._reading.start()
        self._end = weakref.finalize(self, _end, process, self._reading, file)

    @property
    def running(self) -> bool:
        """Whether the process runs."""
        return self._process.poll() is None

    def stop(self) -> None:
        """Ends the session as Ctrl-C does; a recording is completed.  No effect if it has ended."""
        self._end()

    def __enter__(self) -> Touch:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    @property
    def error(self) -> str:
        """Why the process has ended, such as a scene that cannot be assembled; empty: no error."""
        if self.running:
            return ""
        self._reading.join()
        last = self.messages[-1] if self.messages else ""
        return str(error_of(last, "", 0)) if last.startswith("palpate: error: ") else ""

    def _ended(self) -> str:
        return "has ended" + (f": {self.error}" if self.error else "")

    def __repr__(self) -> str:
        return f"<palpate.Touch {self.address if self.running else 'that ' + self._ended()}>"

    def _repr_html_(self) -> str:
        if not self.running:
            return f"<p>palpate touch {html.escape(self._ended())}</p>"
        return (f'<iframe src="{html.escape(self.address)}" title="palpate touch" allow="gamepad" '
                f'style="width: 100%; height: {self.height_px}px; border: 0"></iframe>')


def _read(process: subprocess.Popen[str], messages: collections.deque[str]) -> None:
    assert process.stdout is not None
    for line in process.stdout:
        messages.append(line.rstrip())


def _end(process: subprocess.Popen[str], reading: threading.Thread, file: str) -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        process.wait(timeout=PATIENCE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    reading.join()
    for stream in (process.stdin, process.stdout):
        assert stream is not None
        stream.close()
    if file:
        Path(file).unlink(missing_ok=True)


def _written(scene: Scene) -> str:
    """Writes a scene that is not that of its file, and returns the path: its relative paths start there."""
    folder = Path(scene.path).absolute().parent
    stem = re.sub(r"\W+", "-", scene.name).strip("-") or "scene"
    try:
        number, path = tempfile.mkstemp(".toml", f"{stem}-", folder)
    except OSError as failure:
        raise Error(f"touch: cannot write the scene into {folder}, where its relative paths start "
                    f"({failure.strerror}); save it elsewhere, and give the file to touch") from failure
    with open(number, "w", encoding="utf-8") as file:
        file.write(scene.text)
    return path


def _is_of_its_file(scene: Scene) -> bool:
    try:
        return Path(scene.path).read_text("utf-8") == scene.text
    except OSError:
        return False


def touch(scene: Scene | str | os.PathLike[str] = "touch-head", *, scheme: str = "", port: int = 0,
          height_px: int = 640) -> Touch:
    """Runs a scene in real time and serves its page, on which the mouse moves the tool.

    `scene` is a Scene, a file or the name of an included scene; a Scene made from a dict or a text is written
    to a file until the end.  `scheme` and `port` are the options of `palpate touch`.  Returns once the server
    listens, with a Touch that a notebook shows as the page, `height_px` high, while the scene is assembled.
    The page can be opened on this machine only.
    Raises Error for invalid input, and if the program is missing or was built without its server.
    """
    command = [program("touch"), "touch"]
    written = ""
    if isinstance(scene, Scene):
        written = "" if _is_of_its_file(scene) else _written(scene)
        command.append(written or os.path.abspath(scene.path))
        command += [word for change in scene.changes for word in ("--set", change)]
    else:
        command.append(os.fspath(scene))
    command += ["--notebook", "--port", str(port), *(["--scheme", scheme] if scheme else [])]
    # in a session of its own: Ctrl-C of a cell is not for the page; with the pipe, it ends with this process
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True, start_new_session=True)
    lines, found = [], None
    try:
        assert process.stdout is not None and process.stdin is not None
        for line in process.stdout:
            lines.append(line)
            if found := ADDRESS.search(line):
                return Touch(process, found[0], written, height_px)
        process.wait()
        process.stdin.close()
        process.stdout.close()
        raise error_of("".join(lines), "palpate touch", process.returncode)
    except BaseException:
        process.kill()
        if written:
            Path(written).unlink(missing_ok=True)
        raise
