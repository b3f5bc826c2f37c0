#pragma once
#include <memory>

#include "contact/sources.h"
#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/inertia_term.h"
#include "palpate/mesh/mesh.h"

/// Small models that the contact cases share.
namespace palpate::validation {

/// A State of one node block: a surface whose vertices are its nodes, at rest.
struct SurfaceBody {
  dynamics::State state;
  contact::NodeSurface surface;
  explicit SurfaceBody(const TriMesh& mesh);
};

/// Volume between the plane z = 0 and the facets that face down below it [m^3], exact: each triangle is
/// clipped at the plane, and the depth, linear on it, is integrated over what is left.
double volume_below_plane(const TriMesh& mesh);

/// A point mass in every direction of one node block.
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

/// A flat punch under one node: a square of `area` in the plane through the node, `across` x `across` equal
/// samples, over the plane z = 0 of a frame.  Their gaps are the node's height; their arms lie in world axes,
/// so the punch never rotates.
std::unique_ptr<contact::SampleSource> make_punch_source(int node, double area, int across, int frame);

}  // namespace palpate::validation
