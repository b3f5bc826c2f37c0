#!/usr/bin/env python3
"""Packs an installed package as a wheel (binary distribution format 1.0), without network and tools.

    make_wheel.py CONTENT VERSION LICENSE OUT     CONTENT/palpate -> OUT/palpate-VERSION-TAG.whl

The wheel is of this interpreter and this machine (tag linux_x86_64, not manylinux): the Debian libraries that
palpate links stay outside of it.  The same content gives the same bytes.
"""
import base64
import hashlib
import sys
import sysconfig
import zipfile
from pathlib import Path

METADATA = """\
Metadata-Version: 2.1
Name: palpate
Version: {version}
Summary: Haptic rendering of deformable objects, with its error and its price
License: {license}
Requires-Python: >={python}, <{next}
Requires-Dist: numpy
Provides-Extra: plot
Requires-Dist: matplotlib; extra == "plot"
Provides-Extra: frame
Requires-Dist: pandas; extra == "frame"
"""


def tag() -> str:
    """Interpreter, ABI and platform, as in `cp311-cp311-linux_x86_64`."""
    interpreter = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{interpreter}-{interpreter}-{platform}"


def digest(content: bytes) -> str:
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def files_of(content: Path, version: str, license_file: Path) -> dict[str, bytes]:
    """Name in the wheel -> content, all but RECORD."""
    info = f"palpate-{version}.dist-info"
    major, minor = sys.version_info[:2]
    found = [file for file in sorted((content / "palpate").rglob("*"))
             if file.is_file() and "__pycache__" not in file.parts]
    # a wheel has no links: of a library and its links the one that the loader asks for, libX.so.0
    linked = {file.resolve() for file in found if file.is_symlink()}
    out = {file.relative_to(content).as_posix(): file.read_bytes()
           for file in found if file.is_symlink() or file.resolve() not in linked}
    license_text = license_file.read_text(encoding="utf-8")
    metadata = METADATA.format(version=version, license=" ".join(license_text.split()[:9]).rstrip(","),
                               python=f"{major}.{minor}", next=f"{major}.{minor + 1}")
    out[f"{info}/LICENSE"] = license_text.encode()
    out[f"{info}/METADATA"] = metadata.encode()
    out[f"{info}/WHEEL"] = (f"Wheel-Version: 1.0\nGenerator: palpate\nRoot-Is-Purelib: false\n"
                            f"Tag: {tag()}\n").encode()
    return out


def make_wheel(content: Path, version: str, license_file: Path, out: Path) -> Path:
    files = files_of(content, version, license_file)
    record = f"palpate-{version}.dist-info/RECORD"
    lines = [f"{name},{digest(text)},{len(text)}" for name, text in files.items()] + [f"{record},,"]
    files[record] = ("\n".join(lines) + "\n").encode()
    wheel = out / f"palpate-{version}-{tag()}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if ".so" in name else 0o644) << 16
            archive.writestr(entry, text)
    return wheel


if __name__ == "__main__":
    print(make_wheel(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]), Path(sys.argv[4])))
