#include "bones/tree.h"
#include "palpate/core/error.h"

// Stub of bones on joints for a build without Simbody: every function throws Error.

namespace palpate::bones {
namespace {

[[noreturn]] void no_joints() {
  fail(
      "bones on joints: this palpate was built without Simbody; configure with -DPALPATE_WITH_TOOL=ON "
      "(package libsimbody-dev)");
}

}  // namespace

struct BoneTree::Impl {};
BoneTree::BoneTree(std::vector<TreeBone>, const Vec3&) { no_joints(); }
BoneTree::~BoneTree() = default;
int BoneTree::size() const { no_joints(); }
const TreeBone& BoneTree::bone(int) const { no_joints(); }
int BoneTree::q_size() const { no_joints(); }
int BoneTree::u_size() const { no_joints(); }
VecX BoneTree::start() const { no_joints(); }
VecX BoneTree::rigid_start(const Vec3&, const Vec3&, const Vec3&) const { no_joints(); }
dynamics::BlockSpec BoneTree::block(std::string, double, double) const { no_joints(); }
dynamics::RigidMotion BoneTree::motion(const VecX&, const VecX&, int) const { no_joints(); }
Eigen::Ref<const MatX> BoneTree::jacobian(const VecX&, const VecX&, int) const { no_joints(); }
Vec6 BoneTree::bias(const VecX&, const VecX&, int) const { no_joints(); }
const MatX& BoneTree::mass(const VecX&) const { no_joints(); }
VecX BoneTree::force(const VecX&, const VecX&) const { no_joints(); }
void BoneTree::tangent(const VecX&, double, double, MatX&) const { no_joints(); }
void BoneTree::add_geometric_stiffness(const VecX&, const std::vector<ConstantForce>&, MatX&) const {
  no_joints();
}
double BoneTree::potential_energy(const VecX&) const { no_joints(); }
double BoneTree::dissipated_power(const VecX&) const { no_joints(); }

}  // namespace palpate::bones
