#include "node_block.h"
#include "palpate/fem/soft_body.h"
#include "scatter_map.h"

namespace palpate::fem {
namespace {

using dynamics::BorderedMatrix;
using dynamics::StateView;

Materials of_density(double density) {
  Material m;
  m.density = density;
  return m;
}

/// Returns rho V of each element [kg].
std::vector<double> element_masses(const RestElements& elements, const Materials& materials) {
  check(materials, elements.count(), "mass");
  std::vector<double> out(elements.volume);
  for (std::size_t e = 0; e < out.size(); ++e) out[e] *= materials.of(e).density;
  return out;
}

class LumpedMass final : public dynamics::InertiaTerm {
 public:
  LumpedMass(VecX masses, int block_id) : masses_(std::move(masses)), block_id_(block_id) {}
  int block_id() const override { return block_id_; }
  bool diagonal() const override { return true; }

  void add_mass(const StateView& state, double scale, BorderedMatrix& A) const override {
    const int first = block(state).first_node;
    for (int i = 0; i < masses_.size(); ++i) {
      double* block = A.body.block(A.body.diagonal(first + i));
      for (int axis = 0; axis < 3; ++axis) block[4 * axis] += scale * masses_[i];
    }
  }
  void apply(const StateView& state, const VecX& x, VecX& y) const override {
    const int offset = block(state).u_offset;
    for (int i = 0; i < masses_.size(); ++i)
      y.segment<3>(offset + 3 * i) += masses_[i] * x.segment<3>(offset + 3 * i);
  }

 private:
  NodeBlock block(const StateView& state) const {
    return NodeBlock(state, block_id_, static_cast<int>(masses_.size()));
  }
  VecX masses_;
  int block_id_;
};

/// Consistent mass: integral of rho N_a N_b over a tetrahedron = rho V / 20 (1 + delta_ab).
class ConsistentMass final : public dynamics::InertiaTerm {
 public:
  ConsistentMass(const TetMesh& rest, const Materials& materials, int block_id)
      : elements_(make_rest_elements(rest, "mass")),
        masses_(element_masses(elements_, materials)),
        block_id_(block_id) {}
  int block_id() const override { return block_id_; }
  bool diagonal() const override { return false; }
  void add_pattern(dynamics::PatternBuilder& pattern) const override {
    add_element_pattern(elements_, pattern.first_node(block_id_), pattern);
  }

  void add_mass(const StateView& state, double scale, BorderedMatrix& A) const override {
    scatter_.prepare(elements_, block(state).first_node, A.body);
    for (std::size_t e = 0; e < masses_.size(); ++e)
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b)
          A.body.add(scatter_.slot(e, a, b), scale * entry(e, a == b) * Mat3::Identity());
  }
  void apply(const StateView& state, const VecX& x, VecX& y) const override {
    const int offset = block(state).u_offset;
    for (std::size_t e = 0; e < masses_.size(); ++e) {
      Vec3 sum = Vec3::Zero();
      for (const auto& node : elements_.node) sum += x.segment<3>(offset + 3 * node[e]);
      for (const auto& node : elements_.node)
        y.segment<3>(offset + 3 * node[e]) += entry(e, false) * (sum + x.segment<3>(offset + 3 * node[e]));
    }
  }

 private:
  double entry(std::size_t e, bool diagonal) const { return masses_[e] / 20.0 * (diagonal ? 2.0 : 1.0); }
  NodeBlock block(const StateView& state) const {
    return NodeBlock(state, block_id_, elements_.node_count());
  }
  RestElements elements_;
  std::vector<double> masses_;  ///< element masses [kg]
  int block_id_;
  mutable ScatterMap scatter_;
};

}  // namespace

VecX lumped_masses(const TetMesh& rest, const Materials& materials) {
  check(materials, static_cast<int>(rest.tets.cols()), "mass");
  const RestElements elements = make_rest_elements(rest, "mass");
  if (materials.of_element.empty())
    return materials.list[0].density *
           Eigen::Map<const VecX>(elements.nodal_volume.data(), elements.node_count());
  VecX out = VecX::Zero(elements.node_count());
  const std::vector<double> masses = element_masses(elements, materials);
  for (std::size_t e = 0; e < masses.size(); ++e)
    for (const auto& node : elements.node) out[node[e]] += 0.25 * masses[e];
  return out;
}
VecX lumped_masses(const TetMesh& rest, double density) { return lumped_masses(rest, of_density(density)); }

std::shared_ptr<dynamics::InertiaTerm> make_lumped_mass(const TetMesh& rest, const Materials& materials,
                                                        int block_id) {
  return std::make_shared<LumpedMass>(lumped_masses(rest, materials), block_id);
}
std::shared_ptr<dynamics::InertiaTerm> make_lumped_mass(const TetMesh& rest, double density, int block_id) {
  return make_lumped_mass(rest, of_density(density), block_id);
}

std::shared_ptr<dynamics::InertiaTerm> make_consistent_mass(const TetMesh& rest, const Materials& materials,
                                                            int block_id) {
  return std::make_shared<ConsistentMass>(rest, materials, block_id);
}
std::shared_ptr<dynamics::InertiaTerm> make_consistent_mass(const TetMesh& rest, double density,
                                                            int block_id) {
  return make_consistent_mass(rest, of_density(density), block_id);
}

}  // namespace palpate::fem
