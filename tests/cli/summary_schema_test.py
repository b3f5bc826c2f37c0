#!/usr/bin/env python3
"""summary.json has the keys that docs/files.md lists, with their types and units; and no others.

    summary_schema_test.py PROGRAM [unittest's names of tests]
"""
import json
import re
import sys
import unittest
from typing import NamedTuple

from program import PROGRAM, TREE, Cli

TYPES = {
    "text": lambda value: isinstance(value, str),
    "boolean": lambda value: isinstance(value, bool),
    "integer": lambda value: isinstance(value, int) and not isinstance(value, bool),
    "number": lambda value: value is None or isinstance(value, (int, float)) and not isinstance(value, bool),
    "object": lambda value: isinstance(value, dict),
    "list of text": lambda value: isinstance(value, list) and all(isinstance(one, str) for one in value),
    "list of integers": lambda value: isinstance(value, list) and all(isinstance(one, int) for one in value),
    "list of numbers": lambda value: isinstance(value, list) and all(map(TYPES["number"], value)),
}
# Longest first: "_n_m" is the ending of a stiffness and of a torque.
UNITS = {"n_m_rad": ("N m/rad",), "n_s_m": ("N s/m",), "per_s": ("1/s",), "n_m": ("N m", "N/m"),
         "mib": ("MiB",), "rad": ("rad",), "m2": ("m²",), "m": ("m",), "n": ("N",), "j": ("J",), "s": ("s",)}
SNAKE_CASE = re.compile("[a-z][a-z0-9]*(_[a-z0-9]+)*")
# Keys that no scene of this test has: they need an event that is rare, a peer, or minutes.
ELSEWHERE = {"figures.options.ordering", "figures.sizes.smallest_step_part",
             "figures.monolithic_reference.trouble",
             "figures.virtual_time_reference.trouble", "figures.cells.total", "figures.cells.unexpected",
             "figures.timings.cells_cpu_s"}

# Counters of devices that need hardware, a driver or a peer (devices_test.py).
OF_DEVICES = ("wrenches_unsent", "poses_accepted", "poses_not_finite", "poses_out_of_bounds",
              "us_in_longest_driver_call", "motion_packets", "button_packets", "other_packets", "pad_events",
              "rumble_changes", "connections_lost")


class Row(NamedTuple):
    kind: str
    unit: str


def documented(text):
    """Returns the keys of docs/files.md with type and unit; those below the first table are in `figures`."""
    out = {}
    section = text.split("\n## summary.json\n")[1].split("\n## ")[0]
    for number, part in enumerate(section.split("\n### ")[1:]):
        for key, kind, unit in re.findall(r"(?m)^\| `([^`]+)` \| ([^|]+) \| ([^|]*)\|", part):
            path = key if number == 0 else f"figures.{key}"
            if path in out:
                raise ValueError(f"docs/files.md lists {path} twice")
            out[path] = Row(kind.strip(), unit.strip())
    return out


def leaves(value, path=""):
    """Yields path and value of each leaf: "figures.hands[].ticks", 20."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for row in value:
            yield from leaves(row, f"{path}[]")
    else:
        yield path, value


def unit_of(key):
    """Returns the units that the ending of a key may stand for; none for a number without a unit."""
    return next((units for ending, units in UNITS.items() if key.endswith(f"_{ending}")), ("",))


def problems(summary, schema):
    """Returns what a summary has against the schema, a line each."""
    out = []
    for path, value in leaves(summary):
        if not all(SNAKE_CASE.fullmatch(key.removesuffix("[]")) for key in path.split(".")):
            out.append(f"{path}: not snake_case")
        if path not in schema:
            out.append(f"{path}: not in docs/files.md")
        elif not TYPES[schema[path].kind](value):
            out.append(f"{path}: {value!r} is no {schema[path].kind}")
    return out


class Schema(Cli):
    @classmethod
    def setUpClass(cls):
        cls.schema = documented((TREE / "docs/files.md").read_text())

    def summary(self, *command, **environment):
        """Runs a command and returns its summary.json, after checking it."""
        self.good(*command, "-o", "out", **environment)
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertEqual(next(iter(summary)), "schema_version")
        self.assertEqual(summary["schema_version"], 1)
        self.assertEqual(problems(summary, self.schema), [], command)
        return summary

    def test_units_of_the_table_are_those_in_the_names(self):
        self.assertGreater(len(self.schema), 200)
        for path, (kind, unit) in self.schema.items():
            with self.subTest(key=path):
                self.assertIn(kind, TYPES)
                if kind == "number":
                    self.assertIn(unit, unit_of(path))
                else:
                    self.assertEqual(unit, "" if kind != "list of numbers" else unit)

    def test_a_key_that_is_not_listed_is_found(self):
        lacking = dict(self.schema)
        del lacking["figures.hands[].peak_force_n"]
        summary = {"schema_version": "1", "figures": {
            "hands": [{"name": "tool", "peak_force_n": 1.0}], "real time": {"stalls": 1}}}
        self.assertEqual(problems(summary, lacking), [
            "schema_version: '1' is no integer", "figures.hands[].peak_force_n: not in docs/files.md",
            "figures.real time.stalls: not snake_case", "figures.real time.stalls: not in docs/files.md"])

    def test_results_have_the_keys_of_the_table(self):
        found = set()

        def take(*command, **environment):
            summary = self.summary(*command, **environment)
            found.update(path for path, _ in leaves(summary))
            return summary["figures"]

        def change(*changes):
            return [word for one in changes for word in ("--set", one)]

        # two bodies, a tool, contact in image space and with shapes in formulas
        figures = take("run", "press-stack", "--duration-s", "0.1", "--passivity", "control",
                       "--against-monolithic", *change("contact.1.method=image",
                                                       "compare.haptic.reference_rtol=1e-4"))
        self.assertEqual([contact["between"] for contact in figures["contacts"]],
                         [["slab", "floor"], ["slab", "ball"], ["ball", "tool"], ["tool", "floor"]])
        methods = [contact["method"] for contact in figures["contacts"]]
        self.assertEqual(methods, ["plane", "image", "sphere", "plane"])
        for contact in figures["contacts"]:
            images = contact["method"] == "image"
            self.assertEqual("normals_kept" in contact, images)
            self.assertEqual("triangle_pairs" in contact, images)
            self.assertNotIn("proxy_pairs", contact, "no body has proxies")
        self.assertEqual([hand["name"] for hand in figures["hands"]], ["tool"])
        self.assertEqual([error["hand"] for error in figures["against_monolithic"]], ["tool"])
        figures = take("run", "press-stack", "--duration-s", "0.05")
        self.assertEqual(figures["contacts"][1]["method"], "distance")
        figures = take("run", "lift-ball", "--duration-s", "0.25")
        self.assertEqual(figures["grasps"]["closed"], 1)
        figures = take("run", "press-ball", "--duration-s", "0.1", "--realtime",
                       *change("integrator.name=cvode-bdf"))
        self.assertEqual(figures["real_time"]["ticks_timed"], figures["hands"][0]["ticks"])
        # a step takes longer than such a tick
        figures = take("run", "press-ball", "--duration-s", "0.05", "--realtime",
                       *change("exchange.scheme=single_rate", "tool.tick_s=2e-5"))
        self.assertEqual(figures["options"]["exchange_scheme"], "single_rate")
        self.assertGreater(figures["real_time"]["skipped_ticks"], 0)
        (error,) = figures["against_virtual_time"]
        self.assertEqual(error["hand"], "tool")
        self.assertLess(error["force_error_rms_of_peak"], 0.1)
        take("run", "press-ball", "--duration-s", "0.05", "--checkpoint-every", "0.02")
        figures = take("run", "one-tet", "--duration-s", "0.05", "--view", "left", "--zoom", "2", "--picture",
                       *change("view.target_m=[0.1, 0, 0]", "view.up=[0, 1, 0]"))
        self.assertEqual(figures["pictures"]["view_direction"], [-1, 0, 0])
        take("stability", "--haptic", "press-ball")
        take("compare", "--haptic", "press-ball", "--duration-s", "0.06", "--repeats", "1",
             *change("compare.haptic.exchange_periods_s=[0.02, 0.01]",
                     "compare.haptic.ticks_s=[0.002, 0.001]", "compare.haptic.integrators=[]",
                     "compare.haptic.reference_rtol=1e-4", "compare.haptic.reference_refresh_s=4e-3"))
        (self.folder / "s.toml").write_text(
            '[study]\nscenes = ["one-tet"]\n[[sweep]]\n'
            'key = "body.0.youngs_modulus_pa"\nfrom = 1e5\nto = 4e5\ncount = 2\nspacing = "log"\n')
        figures = take("study", "s.toml")
        self.assertEqual(figures["tasks"]["total"], 2)
        elsewhere = ELSEWHERE | {path for path in self.schema if path.startswith("figures.hands[].packets_")}
        elsewhere |= {f"figures.hands[].{name}" for name in OF_DEVICES}
        if (PROGRAM.parent / "palpate-model").exists():
            figures = take("run", "squeeze-ball", "--duration-s", "0.05",
                           *change("contact.1.method=image"),
                           PALPATE_MODELS=str(self.folder / "models"))
            self.assertTrue(any("proxy_pairs" in contact for contact in figures["contacts"]))
        else:
            elsewhere |= {path for path in self.schema if path.startswith("figures.models[]")}
            names = ("pruned_queries", "proxy_pairs", "pairs_after_boxes", "pairs_after_hulls", "regions",
                     "approaching_regions", "rasterised_triangles", "mean_rasterised_share",
                     "largest_normal_rotation_rad")
            elsewhere |= {f"figures.contacts[].{name}" for name in names}
        self.assertEqual(sorted(set(self.schema) - found - elsewhere - {"figures"}), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
