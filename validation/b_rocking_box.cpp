#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "image_backends.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// A box stands on a plane, delta deep, and rocks by a small angle th about its centre of mass, h above its
// base; b is the base's edge across the axis of rotation, l that along it.  Each point of the base pushes
// with k times its depth, upwards.  By the angle the depth changes by th x, and the base moves by h th
// sideways, out from under the centre of mass:
//     moment = -(k I_A - F h) th,      I_A = b^3 l/12,   F = k b l delta = m g.
// That is what a stepper has between two images, when samples stay on the base: its tangent.
//
// A new image sees the base tilted, by an angle that need not be small.  Rotated about the centre of mass, H
// = h - delta above the plane, the point s of the base lies at x = s cos th - h sin th, at the depth delta +
// s sin th - h (1 - cos th); with c = cos th and d = delta - h (1 - c)
//     base:    M = -k l c sin th (c b^3/12 - h b d).
// On the side that goes down the wall leans out over the plane and is seen from below as well, from the
// corner at x1 = c b/2 - h sin th, D1 = d + (b/2) sin th deep, over D1 tan th:
//     wall:    M = -k l sin th (x1 D1^2/(2 c) + sin th D1^3/(6 c^2)),
// to first order k l b delta^2/4 th.  On the other side the wall looks up, and the depth along the normal
// ends at the base.  (The volume of a liquid that is displaced lacks the same on that other side, so that in
// its metacentric formula h is counted from half the depth: the strip counts twice.) The base's border is a
// wall, which pixels count to within one: through images the angle moves the base by a few pixels, and the
// mean over 20 shifts of the grid is taken.
//
// The restoring part is 0.2 N m/rad and the toppling part a third of it: a wrong sign, or a moment that lacks
// the arm, shows.

namespace palpate::validation {
namespace {

constexpr double kStiffness = 1e7, kDepth = 1e-3, kAngle = 0.06;
const Vec3 kSize(0.02, 0.03, 0.02);  // it rocks about y

double moment_at(contact::DepthBackend backend, double angle, const GridShift& shift,
                 const std::string& fault, double* tangent) {
  TriMesh slab = mesh::box_surface(Vec3(0.2, 0.2, 0.05), {4, 4, 1});
  slab.vertices.row(2).array() -= 0.025;
  const double height = 0.5 * kSize.z() - kDepth;  // of the box's centre
  SurfaceBody body(slab);
  // origin of the frame: the centre of mass
  const auto frame = contact::fixed_frame({quaternion_of(Vec3(0, angle, 0)), Vec3(0.011, 0.007, height)});
  contact::ImageOptions options;
  options.backend = backend;
  options.pixels = 200;
  options.candidate_gap = 1e-4;
  options.shift_u = shift.u;
  options.shift_v = shift.v;
  contact::ContactForce term;
  term.add_frame(frame);
  ContactSpec law;
  law.stiffness_pa_m = kStiffness;
  auto source =
      contact::make_image_source(body.surface, mesh::box_surface(kSize, {4, 4, 4}), 0, frame, options);
  if (fault == "arm-does-not-rotate")  // the arm's part along the normal, as on a round surface
    source = spoiled(std::move(source), [](auto& samples) {
      for (auto& s : samples) {
        s.b.slide.z() = s.b.offset.z();
        s.b.offset.z() = 0.0;
      }
    });
  if (fault == "area-lost")
    source = spoiled(std::move(source), [](auto& samples) {
      for (auto& s : samples) s.area *= 0.99;
    });
  term.add_pair(std::move(source), law);
  term.refresh(body.state.view());
  if (tangent) {
    contact::FrameLinearisation linear;
    term.linearise(body.state.view(), 0, linear);
    *tangent = linear.K(1, 1);
  }
  return term.frame_wrench(body.state.view(), 0).moment.y();
}

/// Of a new image, by the formulas above [N m].
double tilted_moment(double angle) {
  const double b = kSize.x(), l = kSize.y(), h = 0.5 * kSize.z(), c = std::cos(angle), s = std::sin(angle),
               d = kDepth - h * (1.0 - c), corner = 0.5 * b * c - h * s, deepest = d + 0.5 * b * s,
               base = c * s * (c * b * b * b / 12.0 - h * b * d),
               wall = s * (corner * deepest * deepest / (2.0 * c) +
                           s * deepest * deepest * deepest / (6.0 * c * c));
  return -kStiffness * l * (base + wall);
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const double b = kSize.x(), l = kSize.y(), restoring = kStiffness * std::pow(b, 3) * l / 12.0,
               h = 0.5 * kSize.z(), toppling = kStiffness * b * l * kDepth * h,
               through_images = -tilted_moment(kAngle) / kAngle;
  for (const contact::DepthBackend backend : image_backends(fault)) {
    double tangent = 0.0, images = 0.0;
    for (int i = 0; i < kGridShifts; ++i) {
      const GridShift shift{(i + 0.5) / kGridShifts, (i + 0.5) / kGridShifts};  // the axes may be swapped
      double one = 0.0;
      moment_at(backend, 0.0, shift, fault, &one);
      tangent += one / kGridShifts;
      images -= (moment_at(backend, kAngle, shift, fault, nullptr) -
                 moment_at(backend, -kAngle, shift, fault, nullptr)) /
                (2.0 * kAngle * kGridShifts);
    }
    const std::string name(contact::backend_name(backend));
    out.push_back({.quantity = name + ": rocking stiffness of the tangent, mean over 20 shifts [N m/rad]",
                   .computed = tangent,
                   .exact = restoring - toppling,
                   .error = std::abs(tangent / (restoring - toppling) - 1.0),
                   .bar = 1e-3});
    out.push_back({.quantity = name + ": rocking stiffness through images [N m/rad]",
                   .computed = images,
                   .exact = through_images,
                   .error = std::abs(images / (through_images)-1.0),
                   .bar = 1e-3,
                   .note = "mean over 20 shifts; the border is counted in pixels"});
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase rocking_box() {
  return {
      .name = "rocking-box",
      .section = "B",
      .summary = "rotational stiffness of a box on a plane: k I_A - m g h_G, by images and by the tangent",
      .why =
          "whether a standing object stays upright is decided by this difference of two parts that are "
          "nearly equal (balance of moments)",
      .quick = true,
      .run = run,
      .faults = {{"arm-does-not-rotate", "of the tangent"}, {"area-lost", "rocking stiffness"}}};
}

}  // namespace palpate::validation
