"""The pages of the documentation, taken apart: what the tests of this folder share."""
import re
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
DOCS = TREE / "docs"
GENERATED = ("keys", "study-keys", "names", "commands")  # by the program: generated_pages_test.py


def pages():
    """Name -> text of README.md and every page of docs/."""
    files = [TREE / "README.md", *sorted(DOCS.rglob("*.md"))]
    return {file.relative_to(TREE).as_posix(): file.read_text(encoding="utf-8") for file in files}


def hand_written():
    return {name: text for name, text in pages().items() if Path(name).stem not in GENERATED}


def fences(text):
    """(language, content) of each fenced block."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", text, re.M | re.S)


def prose(text):
    """The page without its fenced blocks and comments."""
    return re.sub(r"<!--.*?-->", "", re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S), flags=re.S)


def spans(text):
    """What stands in backticks, on one line or two."""
    return [" ".join(span.split()) for span in re.findall(r"`([^`]+)`", prose(text))]


def anchor(heading):
    """The name that GitHub and MkDocs give a heading: letters, digits, `_` and `-`, blanks as `-`."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").lower()
    return re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", text).strip())


def anchors(text):
    return [anchor(line) for line in re.findall(r"^#+ +(.*)$", prose(text), re.M)]


def links(text):
    """The target of each link and picture."""
    return re.findall(r"\]\(([^()\s]+)\)", re.sub(r"`[^`]*`", "", prose(text)))


def table_rows(text):
    """(heading, cells) of each row of each table, without headers; `\\|` is a stroke."""
    heading, previous, out = "", "", []
    for line in prose(text).splitlines():
        if line.startswith("#"):
            heading = line.lstrip("# ")
        elif line.startswith("|") and previous.startswith("|") and not line.startswith("|---"):
            cells = re.split(r"(?<!\\)\|", line)[1:-1]
            out.append((heading, [cell.strip().replace("\\|", "|") for cell in cells]))
        previous = line
    return out


def sentences(text):
    """The sentences of a page's paragraphs and lists, each as its words; not headings, tables and code."""
    lines = ["" if line.startswith(("#", "|", "!")) else line for line in prose(text).splitlines()]
    words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", "\n".join(lines)).replace("**", "")
    out = []
    for block in re.split(r"\n\s*\n|\n(?=[-*] |\d+\. )", words):
        block = re.sub(r"^([-*]|\d+\.) +", "", " ".join(block.split()))
        out += [part.split() for part in re.split(r"(?<=[.?!:])\s+(?=[A-Z`\[(*])", block)]
    return [sentence for sentence in out if len(sentence) >= 3]
