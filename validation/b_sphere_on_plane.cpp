#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/mesh/generators.h"

// Problem: force on a sphere with radius R whose lowest point is fixed at delta0 below a plane.
//
// Exact answer, nearest points: each point of the surface at the depth d has the pressure k d, per area of
// the surface and along the plane's normal. The energy is int k d^2/2 dA, and with dA = 2 pi R dz for a
// sphere
//     F = k int d dA = k pi R delta0^2.
// Exact answer, vertices and images: the pressure is k times the depth per area projected on the plane, so
// that the force is k times the volume below the plane (a spherical cap),
//     F = k pi delta0^2 (3 R - delta0)/3.
//
// Measured: the force on the true sphere, order 2 in the facet size (accepted: 1.9 to 2.1), and on the
// facets, limit 1e-3. Each vertex carries a third of the projected areas around it, so the sum is the
// integral of the depth interpolated over the facets, cut to zero at the vertices instead of along the
// waterline. This error and that of the inscribed facets are both of order h^2; nearest points have only the
// second. The volume of the facets is exact: each triangle is clipped at the plane, and the depth, linear on
// the triangle, is integrated over the rest.

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadius = 0.02, kDepth = 0.004, kStiffness = 5e7;

/// Returns a sphere mesh without symmetry to the plane, with the lowest point of the true sphere at -kDepth.
TriMesh placed_sphere(int subdivisions, int orientation) {
  TriMesh mesh = mesh::sphere(kRadius, subdivisions);
  const Quat rotation =
      Quat(Eigen::AngleAxisd(0.37 + 1.1 * orientation, Vec3(1, 2 - orientation, 3).normalized()));
  mesh.vertices =
      (rotation.toRotationMatrix() * mesh.vertices).colwise() + Vec3(0.011, -0.007, kRadius - kDepth);
  return mesh;
}

/// Returns the force of one source's samples on the body along z [N].
double held_force(SurfaceBody& body, std::unique_ptr<contact::SampleSource> source,
                  const std::shared_ptr<contact::MovingFrame>& frame, const std::string& fault) {
  contact::ContactForce term;
  term.add_frame(frame);
  ContactSpec law;
  law.stiffness_pa_m = kStiffness;
  // "surface-area": area on the sphere instead of its projection, as for an elastic foundation normal to the
  // skin.
  term.add_pair(spoiled(std::move(source),
                        [&](auto& samples) {
                          for (auto& s : samples)
                            s.area *= fault == "half-area"      ? 0.5
                                      : fault == "surface-area" ? kRadius / (kRadius - kDepth - s.gap)
                                                                : 1.0;
                        }),
                law);
  term.refresh(body.state.view());
  return -term.frame_wrench(body.state.view(), 0).force.z();
}

double vertex_force(const TriMesh& mesh, const std::string& fault) {
  SurfaceBody body(mesh);
  const auto frame = contact::fixed_frame();
  return held_force(body,
                    contact::make_plane_source(body.surface, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 1e-6),
                    frame, fault);
}

double image_force(const TriMesh& mesh, const std::string& fault) {
  SurfaceBody body(mesh);
  const auto frame = contact::fixed_frame();
  TriMesh slab = mesh::box_surface(Vec3(6 * kRadius, 6 * kRadius, kRadius), {6, 6, 1});
  slab.vertices.row(2).array() -= 0.5 * kRadius;  // Its upper face is the plane.
  return held_force(
      body, contact::make_image_source(body.surface, slab, 0, frame, {.pixels = 256, .candidate_gap = 1e-6}),
      frame, fault);
}

/// Returns the force by material points of the facets, with the vertices only [N].
double points_force(const TriMesh& mesh, const std::string& fault) {
  SurfaceBody body(mesh);
  const auto frame = contact::fixed_frame();
  const contact::MaterialPoints points =
      contact::material_points(body.surface, mesh.vertices, TetMesh{}, 10.0 * kRadius);
  return held_force(body, contact::make_plane_source(points, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 1e-6),
                    frame, fault);
}

Measurement against(const std::string& quantity, double computed, double exact, double bar) {
  Measurement m;
  m.quantity = quantity;
  m.computed = computed;
  m.exact = exact;
  m.error = std::abs(computed - exact) / std::abs(exact);
  m.bar = bar;
  return m;
}

/// Measures the mean over six orientations against the true sphere on a sequence of refined facets.
template <class Force>
Measurement ladder(const std::string& quantity, double exact, const Force& force) {
  constexpr int kOrientations = 6;
  std::vector<double> h, error;
  double mean = 0.0;
  for (const int n : {16, 24, 32, 48, 64}) {
    mean = 0.0;
    for (int i = 0; i < kOrientations; ++i) mean += force(placed_sphere(n, i)) / kOrientations;
    h.push_back(1.0 / n);
    error.push_back(std::abs(mean / exact - 1.0));
  }
  Measurement m = against(quantity, mean, exact, 1e-3);
  m.order = validation::fitted_order(h, error);
  m.order_low = 1.9;
  m.order_high = 2.1;
  m.refinement = {"facet / edge of the icosahedron", h, error};
  m.note = "order in facet size over 16 to 64 subdivisions of the icosahedron";
  return m;
}

std::vector<Measurement> run(const std::string& fault) {
  const double cap = kStiffness * kPi * kDepth * kDepth * (3 * kRadius - kDepth) / 3.0,
               by_points = kStiffness * kPi * kRadius * kDepth * kDepth;
  const TriMesh mesh = placed_sphere(64, 0);
  const double facets = kStiffness * volume_below_plane(mesh);
  std::vector<Measurement> out;
  out.push_back(ladder("force on the true sphere, nearest points, mean of 6 orientations [N]", by_points,
                       [&](const TriMesh& one) { return points_force(one, fault); }));
  out.push_back(against("force on the facets, vertices [N]", vertex_force(mesh, fault), facets, 1e-3));
  out.push_back(ladder("force on the true sphere, vertices, mean of 6 orientations [N]", cap,
                       [&](const TriMesh& one) { return vertex_force(one, fault); }));
  if (images_work())
    out.push_back(against("force on the facets, image [N]", image_force(mesh, fault), facets, 1e-3));
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase sphere_on_plane() {
  return {"sphere-on-plane",
          "B",
          "force of a sphere held in a plane: k pi R delta^2 by nearest points, k times the cap's volume by "
          "vertices and by an image",
          "the law of contact, independent of the mesh except for its facets (closed forms of a sphere's "
          "zone and cap)",
          false,
          true,
          run,
          {{"half-area", "force on the"}, {"surface-area", "force on the"}}};
}

}  // namespace palpate::validation
