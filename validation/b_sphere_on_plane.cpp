#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "image_backends.h"
#include "palpate/mesh/generators.h"

// A rigid sphere of radius R held with its lowest point delta0 below a plane.  Pressure is k times the depth
// along the plane's normal, over the area projected on the plane, so the force is k times the volume below
// the plane: a spherical cap,
//     F = k pi delta0^2 (3 R - delta0)/3.
// `vertex` sampling: each vertex carries a third of the projected areas around it, so the sum is the integral
// of the depth interpolated over the facets, cut to zero at the vertices instead of along the waterline.
// Both that and the inscribed facets cost h^2.  The facets' own volume is exact: each triangle is clipped at
// the plane, and the depth, linear on it, is integrated over the rest.

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadius = 0.02, kDepth = 0.004, kStiffness = 5e7;

/// A position off every symmetry of the mesh, lowest point of the true sphere at -kDepth.
TriMesh placed_sphere(int subdivisions, int orientation) {
  TriMesh mesh = mesh::sphere(kRadius, subdivisions);
  const Quat rotation =
      Quat(Eigen::AngleAxisd(0.37 + 1.1 * orientation, Vec3(1, 2 - orientation, 3).normalized()));
  mesh.vertices =
      (rotation.toRotationMatrix() * mesh.vertices).colwise() + Vec3(0.011, -0.007, kRadius - kDepth);
  return mesh;
}

/// Force of the samples of one source on the body, along z [N].
double held_force(SurfaceBody& body, std::unique_ptr<contact::SampleSource> source,
                  const std::shared_ptr<contact::MovingFrame>& frame, const std::string& fault) {
  contact::ContactForce term;
  term.add_frame(frame);
  ContactSpec law;
  law.stiffness_pa_m = kStiffness;
  // "surface-area": the area on the sphere instead of its projection, what an elastic foundation normal to
  // the skin would use
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

double pixel_force(contact::DepthBackend backend, const TriMesh& mesh, const std::string& fault) {
  SurfaceBody body(mesh);
  const auto frame = contact::fixed_frame();
  TriMesh slab = mesh::box_surface(Vec3(6 * kRadius, 6 * kRadius, kRadius), {6, 6, 1});
  slab.vertices.row(2).array() -= 0.5 * kRadius;  // its upper face is the plane
  contact::ImageOptions options;
  options.backend = backend;
  options.pixels = 256;
  options.candidate_gap = 1e-6;
  return held_force(body, contact::make_image_source(body.surface, slab, 0, frame, options), frame, fault);
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

std::vector<Measurement> run(const std::string& fault) {
  constexpr int kOrientations = 6;
  const double cap = kPi * kDepth * kDepth * (3 * kRadius - kDepth) / 3.0;
  const std::vector<int> subdivisions = {16, 24, 32, 48, 64};
  std::vector<double> h, error;
  double finest = 0.0;
  for (const int n : subdivisions) {
    double mean = 0.0;
    for (int i = 0; i < kOrientations; ++i) mean += vertex_force(placed_sphere(n, i), fault) / kOrientations;
    h.push_back(1.0 / n);
    error.push_back(std::abs(mean / (kStiffness * cap) - 1.0));
    finest = mean;
  }
  const TriMesh mesh = placed_sphere(subdivisions.back(), 0);
  const double facets = kStiffness * volume_below_plane(mesh);
  std::vector<Measurement> out;
  out.push_back(against("force on the facets, vertex samples [N]", vertex_force(mesh, fault), facets, 1e-3));
  for (const contact::DepthBackend backend : image_backends(fault))
    out.push_back(
        against("force on the facets, pixel samples, " + std::string(contact::backend_name(backend)) + " [N]",
                pixel_force(backend, mesh, fault), facets, 1e-3));
  Measurement sphere = against("force on the true sphere, vertex samples, mean of 6 orientations [N]", finest,
                               kStiffness * cap, 1e-3);
  sphere.order = validation::fitted_order(h, error);
  sphere.order_low = 1.9;
  sphere.order_high = 2.1;
  sphere.refinement = {"facet / edge of the icosahedron", h, error};
  sphere.note = "order in facet size over 16 to 64 subdivisions of the icosahedron";
  out.push_back(sphere);
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase sphere_on_plane() {
  return {"sphere-on-plane",
          "B",
          "Force of a rigid sphere held in a fixed plane against k times the cap's volume",
          "Penalty force per area is stiffness times overlap volume: independent of the mesh up to its own "
          "facets (volume of a spherical cap).",
          false,
          true,
          run,
          {{"half-area", "force on the"}, {"surface-area", "force on the"}}};
}

}  // namespace palpate::validation
