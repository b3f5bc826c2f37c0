#include "palpate/core/error.h"
#include "palpate/tool/tool.h"
#include "tool/simbody_block.h"

// Replaces the Simbody sources in a build without Simbody: every function that needs Simbody throws Error.

namespace palpate::tool {
namespace {

[[noreturn]] void no_tool() {
  fail(
      "[tool]: this palpate was built without Simbody; configure with -DPALPATE_WITH_TOOL=ON (package "
      "libsimbody-dev)");
}

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
StepEquation Tool::step_equation(double, const HandleMotion&, const dynamics::LinearisedContact&) const {
  no_tool();
}
dynamics::RigidMotion Tool::after(double, const Vec6&) const { no_tool(); }
Wrench Tool::coupling_wrench(const Pose&, const Twist&) const { no_tool(); }
Wrench Tool::wrench_on_hand(const Pose&, const Twist&) const { no_tool(); }
void Tool::coupling_tangent(const Pose&, const Twist&, Mat6&, Mat6&) const { no_tool(); }
Mat6 Tool::mass_matrix() const { no_tool(); }
double Tool::kinetic_energy() const { no_tool(); }
double Tool::potential_energy(const Pose&) const { no_tool(); }
double Tool::coupling_energy(const Pose&) const { no_tool(); }

SimbodyTerms make_simbody_terms(int, const ToolSpec&, const Vec3&) { no_tool(); }
dynamics::BlockSpec tool_block(const ToolSpec&) { no_tool(); }

}  // namespace palpate::tool
