#pragma once
#include <memory>

#include "contact/sources.h"
#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/inertia_term.h"
#include "palpate/mesh/mesh.h"

/// Small models shared by the contact cases.
namespace palpate::validation {

/// State with one node block: a surface whose vertices are its nodes, at rest.
struct SurfaceBody {
  dynamics::State state;
  contact::NodeSurface surface;
  explicit SurfaceBody(const TriMesh& mesh);
};

/// Returns the exact volume [m^3] between the plane z = 0 and the facets that face down below it: each
/// triangle is clipped at the plane, and the depth, linear on the triangle, is integrated over the rest.
double volume_below_plane(const TriMesh& mesh);

/// Point mass in each direction of one node block.
class PointMass final : public dynamics::InertiaTerm {
 public:
  PointMass(int block_id, double mass) : block_id_(block_id), mass_(mass) {}
  int block_id() const override { return block_id_; }
  bool diagonal() const override { return true; }
  void add_mass(const dynamics::StateView& state, double scale, dynamics::BorderedMatrix& A) const override;
  void apply(const dynamics::StateView& state, const VecX& x, VecX& y) const override;

 private:
  int block_id_;
  double mass_;
};

/// Builds a flat punch under one node: a square with the given `area` [m^2] in the plane through the node,
/// divided into `across` x `across` equal samples, over the plane z = 0 of a frame. The gaps of the samples
/// equal the height of the node. Their arms are fixed in world axes, so the punch never rotates.
std::unique_ptr<contact::SampleSource> make_punch_source(int node, double area, int across, int frame);

}  // namespace palpate::validation
