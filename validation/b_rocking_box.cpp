#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// Problem: a box on a plane, delta deep, rocks by a small angle th about its centre of mass, h above its
// base; b is the edge of the base across the axis of rotation, l the edge along it. Each point of its surface
// has the pressure k times its depth, per area at rest, along the plane's normal: the energy is k/2 int
// depth^2 dA.
//
// Exact answer (balance of moments): after a rotation about the centre of mass, at the height H = h - delta
// above the plane, the point s of the base has the depth d + s sin th, d = delta - h (1 - cos th); a point z
// above the edge of the base is less deep by z cos th:
//     base                      E(th) = int_{-b/2}^{b/2} (d + s sin th)^2 ds = b d^2 + b^3 sin^2 th/12
//     two walls along the axis  with depths d+- = d +- (b/2) sin th at their feet: (d+^3 + d-^3)/(3 cos th)
//     two walls across it       2/l int (d + s sin th)^3 ds/(3 cos th)
// each times k l/2. The moment is -dU/dth. Any number of points yields it exactly, as the distance from the
// plane is linear: the only quadrature error is along the waterline of the walls, whose triangles are cut
// there.
//
// Measured: the moment of the tilted box, limit 2e-3 for this quadrature error, and the rocking stiffness of
// the tangent, limit 1e-2. The tangent omits terms common to the triangles of a flat contact, and its tilting
// stiffness is too large by 2/n^2 of the restoring part for a base n triangles wide (docs/theory/contact.md).
//
// The restoring part is 0.2 N m/rad and the toppling part a third of it: a wrong sign, or a moment without
// the arm, is detected.

namespace palpate::validation {
namespace {

constexpr double kStiffness = 1e7, kDepth = 1e-3, kAngle = 0.06;
constexpr int kTriangles = 20;       // Across the base.
const Vec3 kSize(0.02, 0.03, 0.02);  // [m]; the box rocks about y.

double moment_at(double angle, const std::string& fault, double* tangent) {
  const double height = 0.5 * kSize.z() - kDepth;  // Height of the box's centre.
  SurfaceBody none(mesh::box_surface(Vec3(1, 1, 1), {1, 1, 1}));
  // Origin of the frame: the centre of mass.
  const auto box = contact::fixed_frame({quaternion_of(Vec3(0, angle, 0)), Vec3(0.011, 0.007, height)});
  contact::ContactForce term;
  term.add_frame(box);
  term.add_frame(contact::fixed_frame());
  const std::array<int, 3> cells{kTriangles, kTriangles * 3 / 2, kTriangles};
  const contact::MaterialPoints points = contact::material_points(
      contact::FrameSurface{mesh::box_surface(kSize, cells), 0, box}, kSize.maxCoeff());
  auto source =
      contact::make_plane_source(points, 1, contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 1e-4);
  if (fault == "arm-does-not-rotate")  // The arm's normal component stays, as on a round surface.
    source = spoiled(std::move(source), [](auto& samples) {
      for (auto& s : samples) {
        s.a.slide.z() = s.a.offset.z();
        s.a.offset.z() = 0.0;
      }
    });
  if (fault == "area-lost")
    source = spoiled(std::move(source), [](auto& samples) {
      for (auto& s : samples) s.area *= 0.99;
    });
  ContactSpec law;
  law.stiffness_pa_m = kStiffness;
  term.add_pair(std::move(source), law);
  term.refresh(none.state.view());
  if (tangent) {
    contact::FrameLinearisation linear;
    term.linearise(none.state.view(), 0, linear);
    *tangent = linear.K(1, 1);
  }
  return term.frame_wrench(none.state.view(), 0).moment.y();
}

/// Returns the energy divided by k l/2, as above [m^3].
double energy_at(double angle) {
  const double b = kSize.x(), l = kSize.y(), h = 0.5 * kSize.z(), c = std::cos(angle), s = std::sin(angle),
               d = kDepth - h * (1.0 - c), up = d + 0.5 * b * s, down = d - 0.5 * b * s;
  return b * d * d + b * b * b * s * s / 12.0 + (up * up * up + down * down * down) / (3.0 * c) +
         2.0 / l * (b * d * d * d + b * b * b * d * s * s / 4.0) / (3.0 * c);
}

/// Returns -dU/dth by a central difference of the closed form [N m].
double tilted_moment(double angle) {
  constexpr double kStep = 1e-5;
  return -0.5 * kStiffness * kSize.y() * (energy_at(angle + kStep) - energy_at(angle - kStep)) /
         (2.0 * kStep);
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const double exact = tilted_moment(kAngle), found = moment_at(kAngle, fault, nullptr),
               stiffness = -(tilted_moment(1e-3) - tilted_moment(-1e-3)) / 2e-3;
  double tangent = 0.0;
  moment_at(0.0, fault, &tangent);
  const double restoring = kStiffness * std::pow(kSize.x(), 3) * kSize.y() / 12.0,
               too_stiff = 2.0 * restoring / (kTriangles * kTriangles);
  out.push_back({.quantity = "moment of the box tilted by 0.06 rad [N m]",
                 .computed = found,
                 .exact = exact,
                 .error = std::abs(found / exact - 1.0),
                 .bar = 2e-3,
                 .note = "the walls' waterlines are cut across triangles"});
  out.push_back({.quantity = "rocking stiffness of the tangent, upright [N m/rad]",
                 .computed = tangent,
                 .exact = stiffness + too_stiff,
                 .error = std::abs(tangent / (stiffness + too_stiff) - 1.0),
                 .bar = 1e-2,
                 .note = fmt::format("{:.4g} by the energy", stiffness)});
  return out;
}

}  // namespace

ValidationCase rocking_box() {
  return {.name = "rocking-box",
          .section = "B",
          .summary =
              "moment and rotational stiffness of a box that rocks on a plane: k I_A - m g h_G and its walls",
          .why =
              "this difference of two nearly equal terms decides whether a standing object remains upright "
              "(balance of moments)",
          .quick = true,
          .run = run,
          .faults = {{"arm-does-not-rotate", "of the tangent"}, {"area-lost", "moment of the box"}}};
}

}  // namespace palpate::validation
