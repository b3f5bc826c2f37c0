#!/usr/bin/env python3
"""Reads the #include lines of the tree and reports dependencies that are not allowed.

    arrows.py [TREE]      prints each violation as FILE:LINE: what, and exits 1 if there is one

ALLOWED is the table of the parts: the other parts that each may include. Everything here is data; the check
is below it.
"""
import re
import sys
from pathlib import Path

BELOW_LOOP = ["core", "mesh", "dynamics", "fem", "distance", "proxy", "gl", "contact", "tool", "device",
              "bones", "linear", "modes", "integrate", "store", "render", "scene"]

ALLOWED = {
    "core": [],
    "mesh": ["core"],
    "shapes": ["core", "mesh"],
    "dynamics": ["core"],
    "fem": ["core", "mesh", "dynamics"],
    "distance": ["core", "mesh"],
    "proxy": ["core", "mesh"],
    "gl": ["core"],
    "contact": ["core", "mesh", "proxy", "distance", "dynamics", "gl"],
    "simbody": [],  # headers of Simbody, in the configuration in which its library was built; see WRAPPERS
    "tool": ["core", "dynamics", "simbody"],
    "device": ["core"],
    "bones": ["core", "mesh", "dynamics", "device", "simbody"],
    "linear": ["core", "dynamics"],
    "modes": ["core", "dynamics", "linear"],
    "integrate": ["core", "dynamics", "linear"],
    "store": ["core", "mesh"],  # mesh: the native mesh file
    "render": ["core", "mesh", "gl"],
    "model": ["core", "mesh", "shapes", "proxy", "store"],
    # src/cli/model_program: the program behind `palpate model`
    "model_program": ["core", "mesh", "proxy", "store", "render", "report", "model", "shapes", "cli"],
    "scene": ["core"],  # and the spec.h of every part: see is_allowed
    "loop": BELOW_LOOP,
    "experiments": ["core", "mesh", "scene", "loop", "store"],
    "haptic_stability": ["core", "mesh", "device", "tool", "scene", "loop"],
    "report": ["core", "mesh", "store"],
    "session": ["core", "scene", "device", "store", "render", "loop", "experiments", "report"],
    "live": ["core", "mesh", "contact", "device", "scene", "loop", "session", "report", "store"],
    # src/cli/touch_program: the program behind `palpate touch`
    "touch_program": ["core", "scene", "live", "cli"],
    "cli": ["core", "shapes", "scene", "store", "render", "loop", "experiments", "haptic_stability", "report",
            "session"],
    "python": BELOW_LOOP + ["loop", "experiments", "session", "validation"],  # of `import palpate`
    "validation": BELOW_LOOP + ["loop", "experiments", "report", "simbody"],  # the cases in validation/
    # validation/stability: the matrix, which assembles its cases from the parts, as validation does
    "stability": BELOW_LOOP + ["loop", "experiments"],
    # validation/program: the program behind `palpate validate` and `palpate stability`
    "validation_program": ["core", "store", "report", "cli", "validation", "stability",
                           "experiments"],
    # benchmarks/product; its fem/: a beam made of the parts themselves, without a scene
    "bench": BELOW_LOOP + ["loop"],
    # benchmarks/product/program: the program behind `palpate bench`
    "bench_program": ["core", "scene", "store", "report", "cli", "bench"],
}

# Parts outside src/ and include/: the innermost folder counts.  #include lines name headers relative to the
# first folder: "product/fem.h", "stability/row.h".
ELSEWHERE = {
    "benchmarks/product/program/": "bench_program",
    "benchmarks/product/": "bench",
    "validation/program/": "validation_program",
    "validation/stability/": "stability",
    "validation/": "validation",
}

# Headers of external libraries, and the only folders that may include them.
OUTSIDE = [
    ("SUNDIALS",
     r"(sundials|cvode|cvodes|arkode|ida|idas|kinsol|nvector|sunmatrix|sunlinsol|sunnonlinsol|sunmemory)/",
     ["src/integrate", "tests/integrate"]),
    ("Simbody", r"(Simbody|SimTK\w*|simbody|simmath)(\.h$|/)",
     ["src/simbody", "src/tool", "src/bones", "tests/isolation", "validation/peers"]),
    ("EGL and OpenGL", r"(EGL|GL|GLES\d?|KHR|epoxy)/", ["src/gl", "src/render", "tests/gl", "tests/render"]),
    ("libccd", r"ccd/", ["src/proxy", "tests/proxy"]),
    ("Qhull", r"libqhull", ["src/proxy"]),
    ("SuiteSparse", r"(suitesparse/)?(cholmod|umfpack|klu|amd|SuiteSparse)\w*\.h", ["src/linear"]),
    ("Spectra", r"Spectra/", ["src/modes"]),
    ("CLI11", r"CLI/", ["src/cli", "benchmarks/product/program", "validation/program"]),
    ("libwebsockets", r"libwebsockets", ["src/live"]),
    ("pybind11", r"pybind11/", ["src/python"]),
    ("toml++", r"toml\+\+/", ["src/scene"]),
    ("SQLite", r"sqlite3\.h", ["src/store"]),
    ("CGAL", r"CGAL/", ["src/model", "src/mesh/polygon.cpp"]),
    ("Gmsh", r"gmshc\.h", ["src/model", "tests/model"]),
    ("pugixml", r"pugixml\.hpp", ["src/model"]),
    ("HDF5", r"(hdf5|H5\w+)\.h", ["src/store", "tests/store", "tests/fuzz"]),
]

# Parts that only wrap a library for others: their headers in src/ may be used by all parts that may include
# them.
WRAPPERS = ["simbody"]

# Folders inside a part that do not include the rest of their part: what they compute with is passed to them.
LOWER_FOLDERS = ["src/loop/coupling/"]

# Headers that users of the library may include, as "palpate/PART/NAME.h". Headers in src/PART, included as
# "PART/NAME.h", are private to the part, except those that src/PART/CMakeLists.txt lists for other parts.
PROMISED = "include/palpate/"
SHARED_HEADERS = re.compile(r"^palpate_shared_headers\((\w+)\s+([^)]*)\)", re.M)

LONG_FILE = 400
SUFFIXES = {".h", ".hpp", ".cpp", ".cc"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]')


def part_of(path):
    """Returns the part that a file belongs to, by its folder under src/ or include/palpate/, or by
    ELSEWHERE."""
    pieces = path.split("/")
    for folder, part in ELSEWHERE.items():
        if path.startswith(folder):
            return part
    if path.startswith(PROMISED) and len(pieces) > 3:
        part = pieces[2]
    elif pieces[0] == "src" and len(pieces) > 2:
        part = pieces[1]
    else:
        return None
    if part == "cli" and pieces[2] in ("model_program", "touch_program"):
        return pieces[2]
    return part


def resolve(path, quoted, name, files):
    """Returns the file of the tree that an include refers to, or None if it is a system header."""
    beside = (Path(path).parent / name).as_posix()
    candidates = ["include/" + name, "src/" + name, "benchmarks/" + name, "validation/" + name]
    if quoted:
        pieces = []
        for piece in beside.split("/"):
            if piece == "..":
                pieces = pieces[:-1]
            elif piece != ".":
                pieces.append(piece)
        candidates.insert(0, "/".join(pieces))
    return next((path for path in candidates if path in files), None)


def shared_headers(tree):
    """Returns the headers in src/ that their parts share with others."""
    return {f"src/{part}/{header}"
            for listing in (tree / "src").glob("*/CMakeLists.txt")
            for part, headers in SHARED_HEADERS.findall(listing.read_text(encoding="utf-8"))
            for header in headers.split()}


def is_spec(path):
    return path.endswith("/spec.h")


def is_allowed(source, target):
    own, other = part_of(source), part_of(target)
    if own == other:
        return True
    if is_spec(target) and (is_spec(source) or own == "scene"):  # plain data may consist of plain data
        return True
    return other in ALLOWED[own]


def includes(tree, path):
    text = (tree / path).read_text(encoding="utf-8", errors="replace")
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1) == '"', match.group(2)


def find_cycle(graph):
    """Returns one cycle of files as a list, or None: depth-first, without recursion."""
    state = {}
    for start in sorted(graph):
        if start in state:
            continue
        stack = [(start, iter(graph[start]))]
        state[start] = "open"
        while stack:
            node, rest = stack[-1]
            step = next(rest, None)
            if step is None:
                state[node] = "done"
                stack.pop()
            elif state.get(step) == "open":
                trail = [entry[0] for entry in stack]
                return trail[trail.index(step):] + [step]
            elif step not in state:
                state[step] = "open"
                stack.append((step, iter(graph.get(step, []))))
    return None


def unit_of(path):
    """Returns (part, name): a header, the source of its name and their NAME_impl.h are one unit."""
    part, pieces = part_of(path), path.split("/")
    folder = next((folder for folder in ELSEWHERE if path.startswith(folder)), None)
    if folder is None:
        deep = path.startswith(PROMISED) or part in ("model_program", "touch_program")
        folder = "/".join(pieces[:3 if deep else 2]) + "/"
    return part, path[len(folder):].rsplit(".", 1)[0].removesuffix("_impl")


def unit_cycles(graph):
    """Returns the groups of units of one part that include each other in a cycle: {part: [[unit, ...]]}.
    `graph` maps each file to the files that it includes.  These are the strongly connected components of
    more than one unit, by the algorithm of Kosaraju and Sharir."""
    edges = {}
    for source, targets in graph.items():
        edges.setdefault(unit_of(source), set())
        for target in targets:
            if unit_of(source) != unit_of(target) and part_of(source) == part_of(target):
                edges[unit_of(source)].add(unit_of(target))
    backwards = {unit: set() for unit in edges}
    for unit, targets in edges.items():
        for target in targets:
            backwards.setdefault(target, set()).add(unit)

    def reached(start, ways, seen):
        """Returns the units that can be reached from `start`, unless seen, each after those behind it."""
        order, stack = [], [(start, iter(sorted(ways.get(start, []))))]
        seen.add(start)
        while stack:
            unit, rest = stack[-1]
            step = next((other for other in rest if other not in seen), None)
            if step is None:
                order.append(unit)
                stack.pop()
            else:
                seen.add(step)
                stack.append((step, iter(sorted(ways.get(step, [])))))
        return order

    seen, order = set(), []
    for unit in sorted(edges, key=str):
        if unit not in seen:
            order += reached(unit, edges, seen)
    seen, cycles = set(), {}
    for unit in reversed(order):
        if unit not in seen:
            component = reached(unit, backwards, seen)
            if len(component) > 1:
                cycles.setdefault(unit[0], []).append(sorted(name for _, name in component))
    return {part: sorted(groups) for part, groups in cycles.items()}


def cycle_breaches(graph):
    """Returns a breach for each cycle of units."""
    return [f"{part}: headers and sources include each other in a cycle: {', '.join(units)}"
            for part, groups in sorted(unit_cycles(graph).items()) for units in groups]


def source_files(tree, folders, suffixes=frozenset(SUFFIXES)):
    return sorted(path.relative_to(tree).as_posix()
                  for folder in folders for path in (tree / folder).rglob("*")
                  if path.suffix in suffixes)


def check(tree):
    """Returns the breaches, a list of strings."""
    tree = Path(tree)
    files = source_files(tree, ["include", "src", "validation", "benchmarks/product"])
    known = set(files)
    shared, used = shared_headers(tree), set()
    breaches, graph = [], {path: [] for path in files}

    for path in files:
        own = part_of(path)
        if own is not None and own not in ALLOWED:
            breaches.append(f"{path}:1: part \"{own}\" is not in the table of parts")
            continue
        for number, quoted, name in includes(tree, path):
            target = resolve(path, quoted, name, known)
            if target is None:
                if name.startswith("palpate/"):
                    breaches.append(f"{path}:{number}: includes {name}, which does not exist")
                continue
            graph[path].append(target)
            if part_of(target) is None or own is None:
                continue
            if own != part_of(target):
                used.add(target)
            elif any(path.startswith(folder) and not target.startswith(folder) for folder in LOWER_FOLDERS):
                breaches.append(f"{path}:{number}: its folder may not include the rest of {own} ({name})")
            if not is_allowed(path, target):
                breaches.append(f"{path}:{number}: {own} may not include {part_of(target)} ({name})")
            elif (own != part_of(target) and target.startswith("src/") and target not in shared
                  and part_of(target) not in WRAPPERS
                  and not path.startswith(Path(target).parent.as_posix() + "/")):
                breaches.append(f"{path}:{number}: {name} is private to {part_of(target)}")
            elif path.startswith("include/") and not target.startswith("include/"):
                breaches.append(f"{path}:{number}: a promised header includes {name}, which is not installed")

    for path in files + source_files(tree, ["tests"]):
        for number, _, name in includes(tree, path):
            for library, pattern, folders in OUTSIDE:
                if re.match(pattern, name) and not any(path == folder or path.startswith(folder + "/")
                                                                  for folder in folders):
                    breaches.append(
                        f"{path}:{number}: {library} ({name}) belongs in {', '.join(folders)} only")

    for path in files + source_files(tree, ["tests"]) + source_files(
            tree, ["src", "validation", "benchmarks", "tests"], {".py"}):
        lines = (tree / path).read_text(encoding="utf-8", errors="replace").count("\n")
        if lines > LONG_FILE:
            breaches.append(f"{path}:{LONG_FILE + 1}: {lines} lines, more than {LONG_FILE}: split it")

    breaches += [f"{header}:1: is listed as shared, but no other part includes it"
                 for header in sorted(shared - used)]
    breaches += link_breaches(tree)
    cycle = find_cycle(graph)
    if cycle:
        breaches.append("include cycle: " + " -> ".join(cycle))
    else:
        breaches += cycle_breaches(graph)
    if not files:
        breaches.append(f"{tree}: no source files found")
    return breaches


def link_breaches(tree):
    """Applies the same table to the libraries that a part links: palpate::PART in its CMakeLists.txt."""
    out = []
    for listing in sorted([*(tree / "src").glob("*/CMakeLists.txt"),
                           *(tree / "benchmarks/product").rglob("CMakeLists.txt"),
                           *(tree / "validation").rglob("CMakeLists.txt")]):
        listing = listing.relative_to(tree).as_posix()
        own = part_of(listing)
        for number, line in enumerate((tree / listing).read_text(encoding="utf-8").splitlines(), 1):
            for other in re.findall(r"palpate::(\w+)", line.split("#")[0]):
                if other != own and other in ALLOWED and other not in ALLOWED.get(own, []):
                    out.append(f"{listing}:{number}: {own} may not link palpate::{other}")
    return out


def main(arguments):
    tree = Path(arguments[0]) if arguments else Path(__file__).resolve().parents[2]
    breaches = check(tree)
    for line in breaches:
        print(line)
    print(f"{len(breaches)} breaches")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
