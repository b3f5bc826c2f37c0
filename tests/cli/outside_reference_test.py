"""Two scenes against external references: the same semi-discrete equations, implemented independently of the
library in NumPy and integrated by SciPy (DOP853 of Hairer, Norsett and Wanner).

    outside_reference_test.py PROGRAM

Linear tetrahedra, F = sum x_a g_a^T, polar F = R S, lumped masses rho V / 4:
    P = 2 mu (F - R) + lambda tr(R^T F - I) R + F (2 mu_d E + lambda_d tr(E) I),   E = sym(F^T F'),
    m_a v_a' = m_a g - sum V P g_a,
held nodes at rest.  (mu_d, lambda_d) are the stiffness damping times (mu, lambda).
"""

import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

try:
    import h5py
    import numpy as np
    from scipy.integrate import solve_ivp
except ImportError as missing:
    print(f"{missing}: the references from outside are skipped")
    sys.exit(77)

PROGRAM = Path(sys.argv[1]).resolve()
SCENES = PROGRAM.parent.parent / "share/palpate/scenes"


class SoftBody:
    """One body of a scene, built from the mesh that the program wrote."""

    def __init__(self, scene, rest, tets):
        body = scene["body"][0]
        young, nu = body["youngs_modulus_pa"], body["poissons_ratio"]
        self.mu = young / (2 * (1 + nu))
        self.lam = young * nu / ((1 + nu) * (1 - 2 * nu))
        self.damping = body["stiffness_damping_s"]
        self.gravity = np.array(scene["scene"]["gravity_m_s2"])
        self.tets = tets
        edges = rest[tets[:, 1:]] - rest[tets[:, :1]]  # as rows
        self.volume = np.abs(np.linalg.det(edges)) / 6
        last = np.linalg.inv(edges)  # as columns: gradients of the last three shape functions
        self.gradients = np.concatenate([-last.sum(axis=2, keepdims=True), last], axis=2)
        self.mass = np.zeros(len(rest))
        np.add.at(self.mass, tets, body["density_kg_m3"] * self.volume[:, None] / 4)
        self.free = np.ones(len(rest), bool)
        for box in body.get("attachment", []):
            inside = (rest >= box["box_min_m"]) & (rest <= box["box_max_m"])
            self.free &= ~inside.all(axis=1)

    def forces(self, x, v):
        F = np.einsum("eai,eja->eij", x[self.tets], self.gradients)
        rate = np.einsum("eai,eja->eij", v[self.tets], self.gradients)
        U, sigma, Vt = np.linalg.svd(F)
        sign = np.linalg.det(U @ Vt)
        U[:, :, 2] *= sign[:, None]
        R = U @ Vt
        one = np.eye(3)
        stretch = np.einsum("eij,eij->e", R, F) - 3
        P = 2 * self.mu * (F - R) + self.lam * stretch[:, None, None] * R
        E = np.transpose(F, (0, 2, 1)) @ rate
        E = 0.5 * (E + np.transpose(E, (0, 2, 1)))
        trace = np.trace(E, axis1=1, axis2=2)[:, None, None]
        P += self.damping * F @ (2 * self.mu * E + self.lam * trace * one)
        on_nodes = -np.einsum("e,eij,eja->eai", self.volume, P, self.gradients)
        out = self.mass[:, None] * self.gravity
        np.add.at(out, self.tets, on_nodes)
        return out

    def rhs(self, _, y):
        x, v = y.reshape(2, -1, 3)
        a = self.forces(x, v) / self.mass[:, None]
        a[~self.free] = 0
        return np.concatenate([np.where(self.free[:, None], v, 0).ravel(), a.ravel()])


def deformation(rest, x, mass):
    """Returns a displacement minus the nearest rigid motion (Kabsch 1976)."""
    c, d = mass @ rest / mass.sum(), mass @ x / mass.sum()
    U, _, Vt = np.linalg.svd((rest - c).T @ ((x - d) * mass[:, None]))
    turn = np.diag([1, 1, np.linalg.det(U @ Vt)])
    return x - d - (rest - c) @ (U @ turn @ Vt)


def overrides_of(scene):
    """The reference of `palpate compare`, with the scene's settings."""
    compare = scene.get("compare", {})
    return {"integrator.name": f'"{compare.get("reference", "cvode-bdf")}"',
            "integrator.rtol": str(compare.get("reference_rtol", 1e-9))}


class Outside(unittest.TestCase):
    def run_scene(self, name, changes):
        scene = tomllib.loads((SCENES / f"{name}.toml").read_text())
        arguments = []
        for key, value in {**overrides_of(scene), **changes}.items():
            arguments += ["--set", f"{key}={value}"]
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([PROGRAM, "run", SCENES / f"{name}.toml", "-o", folder, *arguments], check=True,
                           stdout=subprocess.DEVNULL)
            with h5py.File(Path(folder) / "run.vtkhdf") as file:
                root = file["VTKHDF"]
                steps = root["Steps"]
                times = np.array(steps["Values"])
                n = int(root["NumberOfPoints"][0])
                points = np.array(root["Points"])
                states = np.array([points[first:first + n] for first in steps["PointOffsets"]])
                tets = np.array(root["Connectivity"]).reshape(-1, 4)
        return scene, times, states, tets

    def distance(self, name, changes, method, rtol):
        """Distance of the program's reference from SciPy's, and of SciPy's from itself at a tenth of the
        tolerance."""
        scene, times, states, tets = self.run_scene(name, changes)
        body = SoftBody(scene, states[0], tets)
        y0 = np.concatenate([states[0].ravel(), np.zeros(states[0].size)])
        scale = np.ptp(states[0], axis=0).max()
        found = []
        for tolerance in (10 * rtol, rtol):
            solved = solve_ivp(body.rhs, (0, times[-1]), y0, method=method, t_eval=times, rtol=tolerance,
                               atol=tolerance * scale * 1e-2)
            self.assertTrue(solved.success, solved.message)
            found.append(solved.y.T[:, :y0.size // 2].reshape(states.shape))
        size = sum(body.mass @ (deformation(states[0], x, body.mass) ** 2).sum(axis=1) for x in states)
        away = [np.sqrt(sum(body.mass @ ((a - b) ** 2).sum(axis=1) for a, b in zip(one, found[1])) / size)
                for one in (states, found[0])]
        print(f"{name}: {away[0]:.1e} from {method} at rtol {rtol:g}, whose own error is below {away[1]:.1e}")
        return away

    def check(self, name, changes, bar, method, rtol):
        from_outside, own = self.distance(name, changes, method, rtol)
        self.assertLess(from_outside, bar)
        self.assertLess(own, bar)  # SciPy's error is sufficiently small

    def test_one_tet(self):
        self.check("one-tet", {}, 1e-7, "DOP853", 1e-11)

    def test_cantilever(self):
        """The step is determined by the stability limit: 1e-8 has the cost of 1e-5."""
        self.check("cantilever", {"body.0.mesh.element_size_m": "0.02", "scene.duration_s": "0.1"}, 1e-7,
                   "DOP853", 1e-8)

    def test_other_equations_are_told_apart(self):
        """A stiffness that is wrong by a ten-thousandth exceeds the acceptance limit."""
        original = SoftBody.__init__

        def wrong(body, scene, rest, tets):
            original(body, scene, rest, tets)
            body.mu *= 1.0001

        SoftBody.__init__ = wrong
        try:
            self.assertGreater(self.distance("one-tet", {}, "DOP853", 1e-11)[0], 1e-6)
        finally:
            SoftBody.__init__ = original


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:], verbosity=2)
