"""TOML of Python's values: a scene as a dict becomes the text that the loader reads."""
import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from ._palpate import Error

_ESCAPES = {'"': '\\"', "\\": "\\\\", "\b": "\\b", "\t": "\\t", "\n": "\\n", "\f": "\\f", "\r": "\\r"}


def _text(value: str) -> str:
    """A basic string of TOML: control characters escaped."""
    return '"' + "".join(_ESCAPES.get(c) or (f"\\u{ord(c):04x}" if ord(c) < 32 or ord(c) == 127 else c)
                         for c in value) + '"'


def _key(name: Any) -> str:
    if not isinstance(name, str):
        raise Error(f"a key of a scene must be a text, not {name!r}")
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def value(item: Any) -> str:
    """One value; numbers read back exactly.  NumPy's scalars and arrays, tuples and paths will do."""
    if hasattr(item, "tolist"):
        item = item.tolist()
    elif hasattr(item, "__fspath__"):
        item = item.__fspath__()
    if isinstance(item, bool):
        return "true" if item else "false"
    if isinstance(item, int):
        return str(item)
    if isinstance(item, float):
        return repr(item) if math.isfinite(item) else ("nan" if math.isnan(item) else
                                                       "inf" if item > 0 else "-inf")
    if isinstance(item, str):
        return _text(item)
    if isinstance(item, (list, tuple)):
        return "[" + ", ".join(value(one) for one in item) + "]"
    if isinstance(item, Mapping):
        return "{" + ", ".join(f"{_key(name)} = {value(one)}" for name, one in item.items()) + "}"
    raise Error(f"a scene cannot hold {item!r}; write numbers, texts, True, False, lists and dicts")


def _is_tables(item: Any) -> bool:
    return isinstance(item, (list, tuple)) and bool(item) and all(isinstance(one, Mapping) for one in item)


def _lines(table: Mapping[str, Any], path: str) -> Iterator[str]:
    """Plain values first: in TOML what follows a header belongs to it."""
    for name, item in table.items():
        if not isinstance(item, Mapping) and not _is_tables(item):
            yield f"{_key(name)} = {value(item)}"
    for name, item in table.items():
        here = f"{path}.{_key(name)}" if path else _key(name)
        if isinstance(item, Mapping):
            yield f"[{here}]"
            yield from _lines(item, here)
        elif _is_tables(item):
            for one in item:
                yield f"[[{here}]]"
                yield from _lines(one, here)


def document(tables: Mapping[str, Any]) -> str:
    """A whole scene, its tables as headers, so that a message's line says which."""
    return "\n".join(_lines(tables, "")) + "\n"
