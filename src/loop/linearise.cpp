#include "linearise.h"

#include "palpate/contact/contact_force.h"
#include "palpate/core/error.h"
#ifdef PALPATE_HAS_TOOL
#include "palpate/tool/tool.h"
#endif

namespace palpate::loop {

#ifdef PALPATE_HAS_TOOL
namespace {

using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

// Condensation.  Over one period H the bodies answer the tool as one linearly implicit step does:
//   A du_n = -H (K_nt dx + B_nt dv),   A = M + H D + H^2 K (contact included),   dx_n = H du_n
//   dF     = -K_tt dx - B_tt dv - (H K_tn + B_tn) du_n
// so that  J = dF/dx = -K_tt + H (H K_tn + B_tn) A^-1 K_nt  and  B = dF/dv = -B_tt + H (H K_tn + B_tn) A^-1 B_nt:
// the Schur complement of the step matrix onto the tool.  H -> 0 gives `frozen`, H -> infinity the quasi-static answer K_tt - K_tn K^-1 K_nt.
bool condense(World& world, double H, const contact::FrameLinearisation& c, Mat6& J, Mat6& B) {
  const dynamics::StateView view = world.state.view();
  world.system.step_matrix(view, 1.0, H, H * H, world.condensed_matrix);
  if (world.condenser->factor(world.condensed_matrix) != dynamics::SolveStatus::kOk) return false;
  const Eigen::Index n = c.K_body.rows();
  MatX rhs = MatX::Zero(world.state.layout().u_size, 12);
  rhs.topLeftCorner(n, 6) = c.K_body;
  rhs.topRightCorner(n, 6) = c.B_body;
  for (int dof : world.system.driven_dofs()) rhs.row(dof).setZero();
  MatX answer(rhs.rows(), rhs.cols());
  if (world.condenser->solve(rhs, answer) != dynamics::SolveStatus::kOk || !answer.allFinite()) return false;
  const MatX row = H * (H * c.K_frame + c.B_frame);
  J = -c.K + row * answer.topLeftCorner(n, 6);
  B = -c.B + row * answer.topRightCorner(n, 6);
  return true;
}

}  // namespace

dynamics::LinearisedContact linearise_contact(World& world, std::uint64_t version, double period_s, long& frozen_fallbacks) {
  dynamics::LinearisedContact record;
  record.version = version;
  record.time = world.state.time();
  if (!world.tool_frame) return record;
  contact::FrameLinearisation c;
  world.contact->linearise(world.state.view(), world.tool_frame_index, c);
  record.samples = c.active;
  const Pose x0 = world.tool->pose();
  const Twist v0 = world.tool->twist();
  record.x0 = {x0.rotation.w(), x0.rotation.x(), x0.rotation.y(), x0.rotation.z(), x0.translation.x(), x0.translation.y(), x0.translation.z()};
  Eigen::Map<Vec6>(record.v0.data()) << v0.angular, v0.linear;
  Eigen::Map<Vec6>(record.F0.data()) << c.wrench.moment, c.wrench.force;
  Mat6 J = -c.K, B = -c.B;
  record.source = dynamics::LinearisedContact::Source::kFrozen;
  if (world.condenser && c.active > 0) {
    if (condense(world, period_s, c, J, B))
      record.source = dynamics::LinearisedContact::Source::kCondensed;
    else
      ++frozen_fallbacks;
  }
  Eigen::Map<RowMajor6>(record.J.data()) = J;
  Eigen::Map<RowMajor6>(record.B.data()) = B;
  return record;
}
#else
dynamics::LinearisedContact linearise_contact(World&, std::uint64_t, double, long&) { return {}; }
#endif

}  // namespace palpate::loop
