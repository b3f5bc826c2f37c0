#!/usr/bin/env python3
"""Contacts in the results of a run: forces, depths and energies.

    contact_results_test.py PROGRAM [unittest's names of tests]
"""
import csv
import json
import math
import re
import sys
import unittest

from program import PROGRAM, Cli


class ContactResults(Cli):
    def table(self, file):
        return list(csv.DictReader((self.folder / file).read_text().splitlines()))

    def test_nearest_points_press_as_images_do(self):
        """Nearly the same force, and smoother: error control takes fewer steps."""
        force, torque, steps = {}, {}, {}
        for method in ("image", "distance"):
            said = self.good("run", "press-ball", "--duration-s", "0.3", "--set",
                             f"contact.1.method={method}", "-o", method)
            (self.assertRegex if method == "distance" else self.assertNotRegex)(
                said, r"contact quadrature: ball - tool \S+ % of the largest force \(bound; largest share of "
                      r"one point \S+ %")
            with (self.folder / method / "force.csv").open(newline="") as file:
                rows = list(csv.DictReader(file))
            force[method] = max(float(row["force_z_n"]) for row in rows)
            torque[method] = max(abs(float(row[f"torque_{axis}_n_m"])) for row in rows for axis in "xyz")
            summary = json.loads((self.folder / method / "summary.json").read_text())
            steps[method] = summary["figures"]["counts"]["steps"]
            contact = next(one for one in summary["figures"]["contacts"]
                           if one["between"] == ["ball", "tool"])
            self.assertEqual(contact["method"], "image" if method == "image" else "sphere")
            for name in "largest_quadrature_error", "largest_share_of_a_point":
                self.assertEqual(name in contact, method == "distance")
            for name in "normals_kept", "triangle_pairs":
                self.assertEqual(name in contact, method == "image")
        self.assertLess(contact["largest_quadrature_error"], 0.3)
        self.assertGreater(force["image"], 0.3)
        self.assertAlmostEqual(force["distance"] / force["image"], 1.0, delta=0.2)
        self.assertLess(steps["distance"], steps["image"])
        self.assertLess(torque["distance"], 1e-15)  # the tool is an exact ball, rather than a mesh
        self.assertGreater(torque["image"], 1e-6)

    def test_nearest_points_keep_the_energy_of_a_ball_that_bounces(self):
        """Undamped, with contact queried every 5 ms: with gaps linear in between it would gain some
        percent of energy."""
        fall = 0.02  # [m]
        changed = {}
        for name, method in {"points": "distance", "vertices": "analytic"}.items():
            self.good("run", "falling-ball", "--duration-s", "0.5", "-o", name, *(
                word for change in (f"contact.0.method={method}", "body.0.stiffness_damping_s=0",
                                    f"body.0.position_m=[0, 0, {0.05 + fall}]", "integrator.rtol=1e-6",
                                    "exchange.exchange_period_s=0.005", "record.energy=true")
                for word in ("--set", change)))
            summary = json.loads((self.folder / name / "summary.json").read_text())
            (contact,) = summary["figures"]["contacts"]
            self.assertEqual(contact["between"], ["ball", "floor"])
            self.assertGreater(contact["deepest_overlap_m"], 1e-4)
            with (self.folder / name / "energy.csv").open(newline="") as file:
                rows = list(csv.DictReader(file))
            potential = 1000 * 4 / 3 * math.pi * 0.05 ** 3 * 9.81 * fall
            changed[name] = max(abs(float(row["changed_by_queries_j"]) + float(row["unaccounted_j"]))
                                for row in rows) / potential
        self.assertLess(changed["points"], 1e-3)
        self.assertGreater(changed["vertices"], 3e-3)

    def test_deep_penetration_is_reported_with_its_time_and_depth(self):
        """A block of 5 cm weighs 490 Pa on its floor: at 1e4 Pa/m it would come to rest 4.9 cm deep."""
        scene = """
            [scene]
            name = "deep"
            duration_s = 0.15
            gravity_m_s2 = [0.0, 0.0, -9.81]
            [[body]]
            name = "block"
            position_m = [0.0, 0.0, 0.026]
            mesh = { generator = "box", size_m = [0.05, 0.05, 0.05], element_size_m = 0.025 }
            youngs_modulus_pa = 5e4
            poissons_ratio = 0.4
            [[obstacle]]
            name = "floor"
            type = "plane"
            [[contact]]
            between = ["block", "floor"]
            stiffness_pa_m = 1e4
            [integrator]
            name = "linearly-implicit-euler"
            step_s = 0.002
            """
        (self.folder / "deep.toml").write_text(scene)
        warned = self.call("run", "deep.toml").stderr
        found = re.search(
            r"contact block - floor at t = (\S+) s: penetration reached (\S+) mm, more than half the "
            r"thickness of the thinner side \(50 mm\): the two may pass through each other\. Increase "
            r"contact\.stiffness_pa_m", warned)
        self.assertTrue(found, warned)
        self.assertLess(abs(float(found[1]) - math.sqrt(2 * 0.026 / 9.81)), 0.03)  # free fall by 2.5 cm
        self.assertGreaterEqual(float(found[2]), 25.0)
        begins = self.refused("run", "deep.toml", "--set", "body.0.position_m=[0, 0, -0.005]", "-o", "begins")
        self.assertIn('"block" starts 30 mm inside "floor"; move "block" by 30 mm along (0, 0, 1)', begins)
        self.assertNotIn("data written so far", begins)
        firm = self.call("run", "deep.toml", "--set", "contact.0.stiffness_pa_m=1e6", "-o", "firm")
        self.assertNotIn("penetration reached", firm.stderr)

    def test_the_order_of_a_contacts_names_changes_no_byte(self):
        swapped = [f"contact.{i}.between={names}" for i, names in enumerate(
            ['["floor", "slab"]', '["slab", "ball"]', '["tool", "ball"]', '["floor", "tool"]'])]
        run = ["run", "press-stack", "--duration-s", "0.1"]
        self.good(*run, "-o", "one")
        self.good(*run, *(word for change in swapped for word in ("--set", change)), "-o", "other")
        for file in ("force.csv", "energy.csv"):
            one = (self.folder / "one" / file).read_bytes()
            self.assertGreater(len(one), 1000)
            self.assertEqual(one, (self.folder / "other" / file).read_bytes(), file)
        rows = self.table("one/energy.csv")
        self.assertEqual(len(rows), 50)
        for energy in "contact_j", "elastic_j", "work_of_hand_j":
            self.assertGreater(max(float(row[energy]) for row in rows), 1e-5, energy)

    def test_squeeze_ball_presses_to_forty_percent_and_accounts_for_its_energy(self):
        if not (PROGRAM.parent / "palpate-model").exists():
            self.skipTest("this build makes no models")
        done = self.call("run", "squeeze-ball", "-o", "out", PALPATE_MODELS=str(self.folder / "models"))
        self.assertEqual(done.returncode, 0, done.stderr)
        lowest = min(float(row["tool_z_m"]) for row in self.table("out/force.csv"))
        pressed = 0.06 - (lowest - 0.005)  # height of the ball minus that of the plate's lower face
        self.assertAlmostEqual(pressed / 0.03, 0.40, delta=0.005)
        rows = [{name: float(value) for name, value in row.items()} for row in self.table("out/energy.csv")]
        self.assertEqual(len(rows), 1200)
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertEqual(summary["figures"]["energy"]["unaccounted_j"], rows[-1]["unaccounted_j"])
        work = max(row["work_of_hand_j"] for row in rows)
        elastic = max(row["elastic_j"] for row in rows)
        self.assertGreater(elastic, 0.4 * work)
        for row in rows:
            self.assertLess(abs(row["unaccounted_j"]), 0.002 * work, row)
        self.assertLess(rows[-1]["elastic_j"], 2e-3 * elastic)  # it has its original shape again


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
