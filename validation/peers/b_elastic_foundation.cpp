#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"
#include "simbody/contact_headers.h"

// Problem: Simbody's ElasticFoundationForce as a peer, for the same sphere, delta0 deep in the same plane,
// with the same stiffness k per area.
//
// Exact answer: it has one spring per triangle, with the triangle's area and the distance of its centroid
// from the nearest point of the other surface; contact by nearest points has springs at the corners of the
// triangles, with their areas at rest. As the mesh is refined both forces tend to
//     k int depth dA over the sphere = k 2 pi R int_0^delta0 t dt = k pi R delta0^2.
// Measured: the peer against this value (order 1.9 to 2.2, limit 5e-3), and the ratio of both forces on the
// same meshes, limit 1e-3.

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadius = 0.02, kDepth = 0.004, kStiffness = 5e7;
constexpr int kOrientations = 3;

/// Returns a rotated sphere, centred at the origin.
TriMesh turned_sphere(int subdivisions, int orientation) {
  TriMesh mesh = mesh::sphere(kRadius, subdivisions);
  const Eigen::AngleAxisd turn(0.37 + 1.1 * orientation, Vec3(1, 2 - orientation, 3).normalized());
  mesh.vertices = (turn.toRotationMatrix() * mesh.vertices).eval();
  return mesh;
}

/// Returns the force of Simbody's elastic foundation on the sphere along z [N].
double peer_force(const TriMesh& mesh) {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter(system);
  SimTK::GeneralContactSubsystem contacts(system);
  SimTK::GeneralForceSubsystem forces(system);
  SimTK::Array_<SimTK::Vec3> vertices;
  SimTK::Array_<int> faces;
  for (const auto& x : mesh.vertices.colwise()) vertices.push_back(SimTK::Vec3(x.x(), x.y(), x.z()));
  for (const auto& face : mesh.faces.colwise())
    for (const int corner : face) faces.push_back(corner);
  const SimTK::ContactSetIndex set = contacts.createContactSet();
  // Simbody's half space is x > 0 in its frame: rotated so that it is below z = 0.
  contacts.addBody(set, matter.updGround(), SimTK::ContactGeometry::HalfSpace(),
                   SimTK::Transform(SimTK::Rotation(0.5 * kPi, SimTK::YAxis)));
  SimTK::MobilizedBody::Translation sphere(
      matter.updGround(),
      SimTK::Body::Rigid(SimTK::MassProperties(1.0, SimTK::Vec3(0), SimTK::Inertia(1.0))));
  contacts.addBody(set, sphere, SimTK::ContactGeometry::TriangleMesh(vertices, faces), SimTK::Transform());
  SimTK::ElasticFoundationForce foundation(forces, contacts, set);
  foundation.setBodyParameters(SimTK::ContactSurfaceIndex(1), kStiffness, 0.0, 0.0, 0.0, 0.0);
  SimTK::State state = system.realizeTopology();
  sphere.setQToFitTranslation(state, SimTK::Vec3(0.0, 0.0, kRadius - kDepth));
  system.realize(state, SimTK::Stage::Dynamics);
  return system.getRigidBodyForces(state, SimTK::Stage::Dynamics)[sphere.getMobilizedBodyIndex()][1][2];
}

/// Returns the force by nearest points on the same triangles [N]. Fault "projected-area": the volume law,
/// with areas projected along the normal.
double our_force(TriMesh mesh, const std::string& fault) {
  mesh.vertices.row(2).array() += kRadius - kDepth;
  SurfaceBody body(mesh);
  const auto frame = contact::fixed_frame();
  contact::ContactForce term;
  term.add_frame(frame);
  auto source = contact::make_plane_source(
      contact::material_points(body.surface, mesh.vertices, TetMesh{}, 10.0 * kRadius), 0, frame,
      Vec3::Zero(), Vec3::UnitZ(), 1e-6);
  if (fault == "projected-area")
    source = spoiled(std::move(source), [](auto& samples) {
      for (auto& s : samples) s.area *= (kRadius - kDepth - s.gap) / kRadius;
    });
  ContactSpec law;
  law.stiffness_pa_m = kStiffness;
  term.add_pair(std::move(source), law);
  term.refresh(body.state.view());
  return -term.frame_wrench(body.state.view(), 0).force.z();
}

std::vector<Measurement> run(const std::string& fault) {
  const double peer_limit = kStiffness * kPi * kRadius * kDepth * kDepth;
  std::vector<double> h, error;
  double peer = 0.0, ours = 0.0;
  for (const int subdivisions : {12, 17, 24, 34}) {
    peer = ours = 0.0;
    for (int i = 0; i < kOrientations; ++i) {
      const TriMesh mesh = turned_sphere(subdivisions, i);
      peer += peer_force(mesh) / kOrientations;
      if (subdivisions == 34) ours += our_force(mesh, fault) / kOrientations;
    }
    h.push_back(1.0 / subdivisions);
    error.push_back(std::abs(peer / peer_limit - 1.0));
  }
  std::vector<Measurement> out;
  out.push_back({.quantity = "Simbody's force, finest mesh, mean of 3 orientations, against its limit [N]",
                 .computed = peer,
                 .exact = peer_limit,
                 .error = error.back(),
                 .bar = 5e-3,
                 .order = fitted_order(h, error),
                 .order_low = 1.9,
                 .order_high = 2.2,
                 .note = "order in facet size over 12 to 34 subdivisions of the icosahedron"});
  out.push_back({.quantity = "Simbody's force over ours on the same meshes",
                 .computed = peer / ours,
                 .exact = 1.0,
                 .error = std::abs(peer / ours - 1.0),
                 .bar = 1e-3,
                 .note = fmt::format("{:.5g} N and {:.5g} N", peer, ours)});
  return out;
}

}  // namespace

ValidationCase elastic_foundation_peer() {
  return {
      .name = "elastic-foundation-peer",
      .section = "B",
      .summary =
          "Simbody's ElasticFoundationForce on the same sphere and plane: its limit, and its ratio to "
          "ours, 1",
      .why =
          "two independent codes with the same law on the same problem (elastic foundation: Sherman, Seth, "
          "Delp 2011)",
      .quick = true,
      .run = run,
      .faults = {{"projected-area", "force over ours"}}};
}

}  // namespace palpate::validation
