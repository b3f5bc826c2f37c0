// Contact of rotated and reflected scenes, and of a ball carried round another ball.
#include "bodies.h"

using namespace distance_tests;

namespace {

/// The 48 maps of the axes onto each other; half of them are reflections.
std::vector<Mat3> axis_maps() {
  std::vector<Mat3> out;
  std::array<int, 3> axis = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 map = Mat3::Zero();
      for (int k = 0; k < 3; ++k) map(k, axis[static_cast<std::size_t>(k)]) = signs >> k & 1 ? -1.0 : 1.0;
      out.push_back(map);
    }
  } while (std::next_permutation(axis.begin(), axis.end()));
  return out;
}

TriMesh mapped(TriMesh mesh, const Mat3& map) {
  mesh.vertices = (map * mesh.vertices).eval();
  if (map.determinant() < 0.0) mesh.faces.row(1).swap(mesh.faces.row(2));  // outward orientation again
  return mesh;
}

/// A body's rest surface with its vertices at the current nodes.
TriMesh placed(TriMesh mesh, const Mat3& turn, const Vec3& shift) {
  mesh.vertices = ((turn * mesh.vertices).colwise() + shift).eval();
  return mesh;
}

}  // namespace

// The search uses single precision about a local origin; feet, gaps and sums use double, so that force and
// moment transform with the scene to double precision.
TEST(Symmetry, ForceAndMomentGoWithRotationsAndReflectionsOfTheScene) {
  const TriMesh one = bumpy_sphere(0.1, 14, 0.05),
                other =
                    placed(bumpy_sphere(0.08, 12, 0.06), rotation({0.3, -0.8, 0.4}), {0.168, 0.01, -0.006});
  Resultant first;
  int checked = 0;
  for (const Mat3& map : axis_maps()) {
    Body a = shell(mapped(one, map)), b = shell(mapped(other, map));
    SkinContact contact(a.skin, b.skin, {.stiffness_pa_m = 1e6});
    contact.find(a.at(), b.at());
    const Resultant now = contact.resultant();
    if (checked++ == 0) {
      first = {map.transpose() * now.force, map.determinant() * (map.transpose() * now.moment)};
      ASSERT_GT(first.force.norm(), 1.0);
    }
    EXPECT_LT((now.force - map * first.force).norm(), 1e-11 * first.force.norm());
    // a moment is an axial vector
    EXPECT_LT((now.moment - map.determinant() * (map * first.moment)).norm(), 1e-11 * first.moment.norm());
  }
  EXPECT_EQ(checked, 48);
}

// A ball of 20 mm is carried round one of 30 mm at 3 mm of overlap. Both are polyhedra, whose facets are
// noticeable. On any mesh the energy leaves no work around the loop; errors of direction, moment about the
// centre and force jumps decrease with the facet size.
TEST(Symmetry, ABallCarriedRoundABall) {
  struct Measured {
    double angle_deg = 0.0, arm_mm = 0.0, jump = 0.0, work = 0.0;
  };
  const auto carried = [](double refined, double spacing, int steps) {
    const auto ball = [&](double radius, double element) {
      return shell(mesh::boundary(mesh::ball(radius, element / refined)).surface);
    };
    Body held = ball(0.03, 0.008), moved = ball(0.02, 0.004);
    SkinContact contact(held.skin, moved.skin, {.stiffness_pa_m = 1e7, .spacing_m = {spacing, spacing}});
    Measured out;
    Vec3 force[3], at[3];
    double path = 0.0, mean = 0.0;
    for (int i = 0; i <= steps; ++i) {
      const double t = 2.0 * M_PI * i / steps;
      std::shift_left(std::begin(force), std::end(force), 1);
      std::shift_left(std::begin(at), std::end(at), 1);
      at[2] = Vec3(0.047 * std::cos(t), 0.0282 * std::sin(t), 0.0376 * std::sin(t));
      moved.place(at[2]);
      contact.find(held.at(), moved.at());
      const Resultant on_held = contact.resultant();
      force[2] = -on_held.force;
      const double size = force[2].norm();
      mean += size / (steps + 1);
      out.angle_deg =
          std::max(out.angle_deg, force[2].cross(at[2]).norm() / (size * at[2].norm()) * 180.0 / M_PI);
      out.arm_mm = std::max(out.arm_mm, 1e3 * (-on_held.moment - at[2].cross(force[2])).norm() / size);
      if (i > 1) out.jump = std::max(out.jump, (force[2] - 2.0 * force[1] + force[0]).norm() / size);
      if (i > 0) {
        out.work += 0.5 * (force[2] + force[1]).dot(at[2] - at[1]);
        path += (at[2] - at[1]).norm();
      }
    }
    out.work = std::abs(out.work) / (mean * path);
    return out;
  };
  const Measured coarse = carried(1.0, 2.3e-3, 2000), fine = carried(4.0, 1.0e-3, 500);
  EXPECT_LT(coarse.work, 1e-4);
  EXPECT_LT(coarse.angle_deg, 1.5);
  EXPECT_LT(coarse.arm_mm, 0.4);
  EXPECT_LT(fine.work, 1e-4);
  EXPECT_LT(fine.angle_deg, 0.2);
  EXPECT_LT(fine.arm_mm, 0.06);
  EXPECT_LT(fine.jump, coarse.jump / 3.0);
}
