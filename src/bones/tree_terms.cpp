#include "bones/tree.h"
#include "dynamics/carried_motion.h"
#include "palpate/core/error.h"

namespace palpate::bones {
namespace {

using dynamics::Block;
using dynamics::StateView;

const Block& block_of(const StateView& state, int block_id, const BoneTree& tree) {
  const Block* block = state.layout->find(block_id);
  PALPATE_CHECK(block && block->kind == dynamics::BlockKind::kArticulated && block->u_size == tree.u_size(),
                "block {} is not a tree of bones of this State", block_id);
  return *block;
}

/// q and u of the block.
struct Coordinates {
  VecX q, u;
  Coordinates(const StateView& state, const Block& block)
      : q(state.q.segment(block.q_offset, block.q_size)), u(state.u.segment(block.u_offset, block.u_size)) {}
};

class TreeInertia final : public dynamics::InertiaTerm {
 public:
  TreeInertia(int block_id, std::shared_ptr<const BoneTree> tree)
      : block_id_(block_id), tree_(std::move(tree)) {}
  int block_id() const override { return block_id_; }
  bool diagonal() const override { return false; }
  void add_mass(const StateView& state, double scale, dynamics::BorderedMatrix& A) const override {
    const Block& block = block_of(state, block_id_, *tree_);
    const int at = block.u_offset - state.layout->nodal_size;
    A.corner.block(at, at, block.u_size, block.u_size) += scale * tree_->mass(Coordinates(state, block).q);
  }
  void apply(const StateView& state, const VecX& x, VecX& y) const override {
    const Block& block = block_of(state, block_id_, *tree_);
    y.segment(block.u_offset, block.u_size) +=
        tree_->mass(Coordinates(state, block).q) * x.segment(block.u_offset, block.u_size);
  }

 private:
  int block_id_;
  std::shared_ptr<const BoneTree> tree_;
};

class TreeForce final : public dynamics::ForceTerm {
 public:
  TreeForce(int block_id, std::shared_ptr<const BoneTree> tree)
      : block_id_(block_id), tree_(std::move(tree)) {}
  std::string_view name() const override { return "bones on joints (Simbody)"; }
  dynamics::TermTraits traits() const override { return {.conservative = true}; }
  void add_force(const StateView& state, VecX& f) override {
    const Block& block = block_of(state, block_id_, *tree_);
    const Coordinates at(state, block);
    f.segment(block.u_offset, block.u_size) += tree_->force(at.q, at.u);
  }
  void add_tangent(const StateView& state, double k_scale, double d_scale,
                   dynamics::BorderedMatrix& A) override {
    const Block& block = block_of(state, block_id_, *tree_);
    const int at = block.u_offset - state.layout->nodal_size;
    tree_->tangent(Coordinates(state, block).q, k_scale, d_scale, tangent_);
    A.corner.block(at, at, block.u_size, block.u_size) += tangent_;
  }
  void apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x,
                     VecX& y) override {
    const Block& block = block_of(state, block_id_, *tree_);
    tree_->tangent(Coordinates(state, block).q, k_scale, d_scale, tangent_);
    y.segment(block.u_offset, block.u_size) += tangent_ * x.segment(block.u_offset, block.u_size);
  }
  double energy(const StateView& state) override {
    return tree_->potential_energy(Coordinates(state, block_of(state, block_id_, *tree_)).q);
  }
  double dissipated_power(const StateView& state) override {
    return tree_->dissipated_power(Coordinates(state, block_of(state, block_id_, *tree_)).u);
  }

 private:
  int block_id_;
  std::shared_ptr<const BoneTree> tree_;
  MatX tangent_;
};

class TreeCarried final : public dynamics::DrivenMotion {
 public:
  TreeCarried(std::vector<int> dofs, Points local, int bone, int block_id,
              std::shared_ptr<const BoneTree> tree)
      : dofs_(std::move(dofs)),
        local_(std::move(local)),
        bone_(bone),
        block_id_(block_id),
        tree_(std::move(tree)) {
    PALPATE_CHECK(static_cast<std::size_t>(local_.cols()) == dofs_.size() && local_.allFinite(),
                  "{} positions for {} directions", local_.cols(), dofs_.size());
  }
  const std::vector<int>& dofs() const override { return dofs_; }
  int master_block() const override { return block_id_; }

  void evaluate(const StateView& state, VecX& x, VecX& v, VecX& a) const override {
    const Coordinates at(state, block_of(state, block_id_, *tree_));
    const Vec6 bias = tree_->bias(at.q, at.u, bone_);
    dynamics::carry(tree_->motion(at.q, at.u, bone_), {bias.head<3>(), bias.tail<3>()}, dofs_, local_, x, v,
                    a);
  }
  void jacobian(const StateView& state, MatX& G) const override {
    const Coordinates at(state, block_of(state, block_id_, *tree_));
    const Mat3 R = tree_->motion(at.q, at.u, bone_).pose.rotation.toRotationMatrix();
    const Eigen::Ref<const MatX> J = tree_->jacobian(at.q, at.u, bone_);
    G.resize(local_.cols(), J.cols());
    for (Eigen::Index i = 0; i < local_.cols(); ++i)
      G.row(i) = J.row(3 + axis(i)) +
                 Vec3(R * local_.col(i)).cross(Vec3::Unit(axis(i))).transpose() * J.topRows<3>();
  }
  void add_geometric_stiffness(const StateView& state, const VecX& f, MatX& K) const override {
    const Coordinates at(state, block_of(state, block_id_, *tree_));
    const Mat3 R = tree_->motion(at.q, at.u, bone_).pose.rotation.toRotationMatrix();
    std::vector<ConstantForce> held(static_cast<std::size_t>(tree_->size()));
    ConstantForce& mine = held[static_cast<std::size_t>(bone_)];
    for (Eigen::Index i = 0; i < local_.cols(); ++i) {
      mine.force[axis(i)] += f[i];
      mine.moment.col(axis(i)) += f[i] * (R * local_.col(i));
    }
    tree_->add_geometric_stiffness(at.q, held, K);
  }

 private:
  int axis(Eigen::Index i) const { return dofs_[static_cast<std::size_t>(i)] % 3; }
  std::vector<int> dofs_;
  Points local_;
  int bone_, block_id_;
  std::shared_ptr<const BoneTree> tree_;
};

}  // namespace

std::shared_ptr<dynamics::InertiaTerm> make_tree_inertia(int block_id, std::shared_ptr<const BoneTree> tree) {
  return std::make_shared<TreeInertia>(block_id, std::move(tree));
}
std::shared_ptr<dynamics::ForceTerm> make_tree_force(int block_id, std::shared_ptr<const BoneTree> tree) {
  return std::make_shared<TreeForce>(block_id, std::move(tree));
}
std::shared_ptr<dynamics::DrivenMotion> make_tree_carried(std::vector<int> dofs, Points local, int bone,
                                                          int block_id,
                                                          std::shared_ptr<const BoneTree> tree) {
  return std::make_shared<TreeCarried>(std::move(dofs), std::move(local), bone, block_id, std::move(tree));
}

}  // namespace palpate::bones
