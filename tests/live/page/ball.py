"""A ball embedded in a grid of tetrahedra, and its dent under a round tool: a scene for tests of the page.

The dent is made, not simulated: nodes move by a smooth bump, the force is a spring in series with the virtual
coupling."""
import itertools
import math
import struct

CORNERS_OF_CELL = [(0, 1, 3, 7), (0, 1, 5, 7), (0, 2, 3, 7), (0, 2, 6, 7), (0, 4, 5, 7), (0, 4, 6, 7)]
STIFFNESS_N_M, COUPLING_N_M = 200.0, 300.0


def sphere(radius, rings, sectors):
    """Returns vertices and triangles, seen from outside anticlockwise."""
    vertices = [(0.0, 0.0, radius)]
    for i in range(1, rings):
        polar = math.pi * i / rings
        vertices += [(radius * math.sin(polar) * math.cos(2 * math.pi * k / sectors),
                      radius * math.sin(polar) * math.sin(2 * math.pi * k / sectors),
                      radius * math.cos(polar)) for k in range(sectors)]
    vertices.append((0.0, 0.0, -radius))
    last = len(vertices) - 1
    triangles = []
    for k in range(sectors):
        after = (k + 1) % sectors
        triangles.append((0, 1 + k, 1 + after))
        triangles.append((last, last - sectors + after, last - sectors + k))
        for i in range(rings - 2):
            a, b = 1 + i * sectors + k, 1 + i * sectors + after
            triangles += [(a, a + sectors, b + sectors), (a, b + sectors, b)]
    return vertices, triangles


def cell_weights(local):
    """Returns the tetrahedron of a unit cell that contains a point, and the point's four weights: the cell
    is cut along its diagonal into six, one per order of the coordinates."""
    order = sorted(range(3), key=lambda axis: -local[axis])
    corners, corner = [0], 0
    for axis in order:
        corner |= 1 << axis
        corners.append(corner)
    steps = [local[axis] for axis in order]
    weights = [1 - steps[0], steps[0] - steps[1], steps[1] - steps[2], steps[2]]
    which = next(i for i, one in enumerate(CORNERS_OF_CELL) if sorted(one) == sorted(corners))
    return which, [weights[corners.index(corner)] for corner in CORNERS_OF_CELL[which]]


class Ball:
    """`cells` per edge of the grid; the skin has about rings * sectors vertices."""

    def __init__(self, radius=0.1, cells=6, rings=24, sectors=48):
        self.radius, self.cells = radius, cells
        side, edge = 2.04 * radius, cells + 1
        self.size = side / cells
        grid = [-side / 2 + side * i / cells for i in range(edge)]
        self.rest = [(x, y, z) for z, y, x in itertools.product(grid, grid, grid)]
        self.skin, self.triangles = sphere(radius, rings, sectors)
        self.tets = []
        for k, j, i in itertools.product(range(cells), repeat=3):
            at = [(k + (c >> 2)) * edge * edge + (j + (c >> 1 & 1)) * edge + i + (c & 1) for c in range(8)]
            self.tets += [tuple(at[c] for c in one) for one in CORNERS_OF_CELL]
        self.tet_of, self.weights = [], []
        for vertex in self.skin:
            scaled = [(one + side / 2) / self.size for one in vertex]
            cell = [min(cells - 1, int(one)) for one in scaled]
            which, weights = cell_weights([one - c for one, c in zip(scaled, cell)])
            self.tet_of.append(6 * (cell[0] + cells * (cell[1] + cells * cell[2])) + which)
            self.weights.append(weights)

    def description(self, name="ball", attached=True):
        return {"name": name, "nodes": len(self.rest), "vertices": len(self.skin), "tets": len(self.tets),
                "triangles": len(self.triangles), "colour": "#d8d2c6", "attached": attached}

    def geometry(self):
        flat = itertools.chain.from_iterable
        return (packed("f", flat(self.rest)) + packed("I", flat(self.tets)) + packed("I", self.tet_of) +
                packed("f", flat(self.weights)) + packed("I", flat(self.triangles)))

    def dented(self, tool, radius):
        """Returns positions and depth [m] of a dent by a tool of `radius` [m] whose centre wants to be at
        `tool`; the tool is pushed back by the dent."""
        distance = math.sqrt(sum(one * one for one in tool)) or 1e-9
        into = [-one / distance for one in tool]
        overlap = self.radius + radius - distance
        if overlap <= 0.0:
            return self.rest, 0.0, into
        depth = overlap * COUPLING_N_M / (COUPLING_N_M + STIFFNESS_N_M)
        touched, width = [-self.radius * one for one in into], 2 * (1.6 * radius) ** 2
        out = []
        for node in self.rest:
            square = sum((a - b) ** 2 for a, b in zip(node, touched))
            bump = depth * math.exp(-square / width)
            out.append([a + bump * b for a, b in zip(node, into)])
        return out, depth, into


def packed(kind, numbers):
    numbers = list(numbers)
    return struct.pack(f"<{len(numbers)}{kind}", *numbers)
