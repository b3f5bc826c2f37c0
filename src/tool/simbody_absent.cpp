#include "palpate/core/error.h"
#include "palpate/tool/bone_tree.h"
#include "palpate/tool/simbody_block.h"
#include "palpate/tool/tool.h"

// Replaces Simbody in a build without it: whatever would need Simbody throws Error.

namespace palpate::tool {
namespace {

[[noreturn]] void absent(const char* what) {
  fail(
      "{}: this palpate was built without Simbody; configure with -DPALPATE_WITH_TOOL=ON (package "
      "libsimbody-dev)",
      what);
}
[[noreturn]] void no_tool() { absent("[tool]"); }
[[noreturn]] void no_joints() { absent("bones on joints"); }

}  // namespace

bool available() { return false; }
const std::vector<ToolIntegratorInfo>& tool_integrators() {
  static const std::vector<ToolIntegratorInfo> none;
  return none;
}
std::string simbody_version() { return {}; }

struct Tool::Impl {};
Tool::Tool(const ToolSpec&, const Vec3&) { no_tool(); }
Tool::~Tool() = default;
Tool::Tool(Tool&&) noexcept = default;
double Tool::time() const { no_tool(); }
Pose Tool::pose() const { no_tool(); }
Twist Tool::twist() const { no_tool(); }
void Tool::set_state(double, const Pose&, const Twist&) { no_tool(); }
dynamics::StepResult Tool::advance(double, const HandleMotion&, const dynamics::LinearisedContact&) {
  no_tool();
}
Wrench Tool::coupling_wrench(const Pose&, const Twist&) const { no_tool(); }
Wrench Tool::wrench_on_hand(const Pose&, const Twist&) const { no_tool(); }
void Tool::coupling_tangent(const Pose&, const Twist&, Mat6&, Mat6&) const { no_tool(); }
Mat6 Tool::mass_matrix() const { no_tool(); }
double Tool::kinetic_energy() const { no_tool(); }
double Tool::potential_energy(const Pose&) const { no_tool(); }

SimbodyTerms make_simbody_terms(int, const ToolSpec&, const Vec3&) { no_tool(); }
dynamics::BlockSpec tool_block(const ToolSpec&) { no_tool(); }

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
void BoneTree::add_geometric_stiffness(const VecX&, const std::vector<HeldForce>&, MatX&) const {
  no_joints();
}
double BoneTree::potential_energy(const VecX&) const { no_joints(); }
double BoneTree::dissipated_power(const VecX&) const { no_joints(); }

}  // namespace palpate::tool
