#include "palpate/fem/load.h"

#include "box.h"
#include "node_block.h"
#include "palpate/core/error.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/boundary.h"

namespace palpate::fem {
namespace {

using dynamics::StateView;

/// Forces that depend on neither state nor time; potential -f . x.
class DeadLoad final : public dynamics::ForceTerm {
 public:
  DeadLoad(std::string name, VecX forces, int block_id)
      : name_(std::move(name)), forces_(std::move(forces)), block_id_(block_id) {}
  std::string_view name() const override { return name_; }
  dynamics::TermTraits traits() const override {
    return {.stiff = false,
            .fast = false,
            .symmetric_tangent = true,
            .has_tangent = true,
            .conservative = true,
            .zero_tangent = true};
  }
  void add_force(const StateView& state, VecX& f) override {
    f.segment(block(state).u_offset, forces_.size()) += forces_;
  }
  void add_tangent(const StateView&, double, double, dynamics::BorderedMatrix&) override {}
  void apply_tangent(const StateView&, double, double, const VecX&, VecX&) override {}
  double energy(const StateView& state) override {
    return -forces_.dot(Eigen::Map<const VecX>(block(state).x, forces_.size()));
  }

 private:
  NodeBlock block(const StateView& state) const {
    return NodeBlock(state, block_id_, static_cast<int>(forces_.size() / 3));
  }
  std::string name_;
  VecX forces_;
  int block_id_;
};

}  // namespace

std::shared_ptr<dynamics::ForceTerm> make_gravity(const VecX& masses, const Vec3& gravity, int block_id) {
  if (!gravity.allFinite())
    fail("gravity_m_s2 = ({}, {}, {}) must be finite", gravity.x(), gravity.y(), gravity.z());
  const Points weights = gravity * masses.transpose();
  return std::make_shared<DeadLoad>("gravity", weights.reshaped(), block_id);
}

std::shared_ptr<dynamics::ForceTerm> make_dead_load(std::string name, const Points& forces, int block_id) {
  if (!forces.allFinite()) fail("load \"{}\": forces must be finite", name);
  return std::make_shared<DeadLoad>(std::move(name), forces.reshaped(), block_id);
}

Points spread_over_boundary(const TetMesh& placed, const LoadSpec& load) {
  check_box(load.box_min_m, load.box_max_m, "load");
  if (!load.force_n.allFinite())
    fail("load: force_n = ({}, {}, {}) must be finite", load.force_n.x(), load.force_n.y(), load.force_n.z());
  const mesh::Boundary boundary = mesh::boundary(placed);
  const double tolerance = selection_tolerance(placed.nodes);
  VecX share = VecX::Zero(placed.nodes.cols());
  for (const auto& face : boundary.surface.faces.colwise()) {
    Eigen::Vector3i node;
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
      node[i] = boundary.node_of_vertex[static_cast<std::size_t>(face[i])];
      inside = inside && in_box(placed.nodes.col(node[i]), load.box_min_m, load.box_max_m, tolerance);
    }
    if (!inside) continue;
    const Vec3 a = placed.nodes.col(node[0]), b = placed.nodes.col(node[1]), c = placed.nodes.col(node[2]);
    const double third = (b - a).cross(c - a).norm() / 6.0;  // a third of the triangle's area
    for (int i = 0; i < 3; ++i) share[node[i]] += third;
  }
  const double area = share.sum();
  if (!(area > 0.0))
    fail("load: no boundary triangle of the mesh lies in the box {}; enlarge the box",
         describe(load.box_min_m, load.box_max_m));
  return load.force_n * (share / area).transpose();
}

}  // namespace palpate::fem
