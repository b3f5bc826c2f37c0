#!/usr/bin/env python3
"""Doxygen's filter for headers: `double a = 0.0, b = 0.0;  ///< both` becomes two declarations with the same
comment, on the same line, as Doxygen gives it to one of them alone.

    split_declarations.py FILE      prints the changed text
"""
import re
import sys

NAME = r"[A-Za-z_]\w*(?:\s*=\s*[^,;(){}]*(?:\(\)|\{\})?|\{[^,;(){}]*\})?"
DECLARATIONS = re.compile(
    rf"^(?P<type>\s*(?:inline |static |constexpr |const )*[\w:]+(?:<[\w:<>, ]+>)?[*&]? ?\*?)\s*"
    rf"(?P<names>{NAME}(?:,\s*\*?{NAME})+);\s*(?:///<\s*(?P<comment>.*))?$")
NO_TYPE = {"return", "using", "friend", "case", "goto", "typedef"}


def split(line, before):
    """`before`: the comment above the line, where it has one."""
    match = DECLARATIONS.match(line)
    if not match or match["type"].strip() in NO_TYPE or line.lstrip().startswith("//"):
        return line
    comment = match["comment"] or before
    names = re.split(r",\s*", match["names"])
    note = f"  /**< {comment} */" if comment else ""
    pieces = [f"{match['type'].rstrip()} {name};{note}" for name in names]
    if not match["comment"]:  # the first has the comment above
        pieces[0] = f"{match['type'].rstrip()} {names[0]};"
    return " ".join(pieces)


def filtered(text):
    out, above = [], []
    for line in text.splitlines():
        stripped = line.strip()
        if stripped.startswith("///") and not stripped.startswith("///<"):
            above.append(stripped[3:].strip())
            out.append(line)
            continue
        out.append(split(line, " ".join(above)))
        above = []
    return "\n".join(out) + "\n"


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        sys.stdout.write(filtered(file.read()))
