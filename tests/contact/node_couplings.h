#pragma once
#include "palpate/contact/contact_force.h"

namespace palpate {

/// One of FrameLinearisation's columns (K_body, B_body) over all `nodal` directions: nodal x 6.
inline MatX columns_of(const contact::FrameLinearisation& from,
                       Eigen::Matrix<double, 3, 6> contact::NodeCoupling::*which, Eigen::Index nodal) {
  MatX out = MatX::Zero(nodal, 6);
  for (const contact::NodeCoupling& one : from.nodes) out.middleRows<3>(3 * one.node) = one.*which;
  return out;
}
/// One of its rows (K_frame, B_frame): 6 x nodal.
inline MatX rows_of(const contact::FrameLinearisation& from,
                    Eigen::Matrix<double, 6, 3> contact::NodeCoupling::*which, Eigen::Index nodal) {
  MatX out = MatX::Zero(6, nodal);
  for (const contact::NodeCoupling& one : from.nodes) out.middleCols<3>(3 * one.node) = one.*which;
  return out;
}

}  // namespace palpate
