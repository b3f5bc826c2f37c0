#include <cmath>

#include "linear.h"

// One oscillator held by two springs: the body's, with frequency w_B, and the contact's, w_C;
// w^2 = w_B^2 + w_C^2, damping ratio 1/20 of both together, distributed in proportion. Additive methods treat
// the contact explicitly, multi-rate ones in fast steps. From the formula of each (integrate/linear_step.h),
// thus from theory:
// - w_B H = w_C H = 0.3: resolved.
// - A stiff body, w_B H = 1e3 or 1e6, and a soft contact, w_C H = 0.3: the implicit side provides the
//   expected damping.
// - A stiff contact on a soft body: additive methods have the limit of their explicit side, as an explicit
//   method has: all five are beyond it at w_C H = 10. So are multi-rate ones: their fast side has the
//   contact's force, but a node's q' = u is slow, and the force is evaluated at the q of the slow stages. (A
//   tool's kinematics are fast: these methods are intended for a light tool on a stiff contact.)
// - Both stiff: no theorem holds, the matrix of the step decides.

namespace palpate::stability {

Row split_row() {
  Row row{
      "split",
      "a stiff mode on the spring of a body and that of a contact, w H of each from 0.3 to 1e6, by methods "
      "that treat the contact explicitly or in fast steps.  Detects a missing split, interchanged sides, and "
      "a step that differs from the method's",
      RowColumns::kSplitting};
  constexpr double kH = 0.01, kDampingRatio = 0.05;
  const auto add = [&row](double body, double contact) {
    const double w = std::hypot(body, contact) / kH, share = contact * contact / (w * w * kH * kH);
    row.cases.push_back(linear_case(
        fmt::format("w H = {:g}, contact {:g}", body, contact),
        [=] { return LinearProblem(w, kDampingRatio, share); }, kH));
  };
  add(0.3, 0.3);
  add(1e3, 0.3);
  add(1e6, 0.3);
  add(1.0, 10.0);
  add(0.3, 100.0);
  add(30.0, 10.0);
  row.core = 3;
  return row;
}

}  // namespace palpate::stability
