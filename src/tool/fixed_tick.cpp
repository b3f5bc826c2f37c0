#include <Eigen/LU>

#include "simbody_body.h"
#include "tick_scheme.h"

namespace palpate::tool {

void move(RigidMotion& motion, double h, const Vec6& u) {
  motion.twist = twist_of(u);
  motion.pose.rotation = (quaternion_of(h * motion.twist.angular) * motion.pose.rotation).normalized();
  motion.pose.translation += h * motion.twist.linear;
}

namespace {

dynamics::StepResult done(const TickInput& input, double residual = 0.0) {
  return {dynamics::StepStatus::kOk, input.t0 + input.h, input.h, 1, 1, residual, {}};
}

// Gyroscopic term of both schemes, in body axes (where I is constant) with L0 = I w0: f = -w x I w is
// approximated by -w1 x L0, so that
//   I (w1 - w0) = -h w1 x L0   gives   w1 . I w1 = w1 . I w0 <= |w1|_I |w0|_I:
// it never adds energy, at any spin and any tick. The explicit term adds energy, and diverges if the tool
// rotates by a radian per tick. As -w1 x L0 = L0 x w1, its matrix G = -[L0] is skew, so the symmetric part of
// M + h (B + G) + h^2 K is positive definite wherever the symmetric parts of K and B are semi-definite.
// Components in the world axes at the start of the tick may be used for body axes, because the rotation
// exp(h w1) does not change w1.
Mat3 gyroscopic_matrix(const Mat6& M, const Twist& twist) {
  return -cross_matrix(M.topLeftCorner<3, 3>() * twist.angular);
}

// (M + h G) (u1 - u0) = h f(x0, u0, handle at the start),  x1 = x0 + h u1.
// For one direction, x1 = z x0:
//   z^2 - (2 - (h^2 k + h b)/m) z + 1 - h b/m = 0;   |z| <= 1 until z = -1, at k = 4 m/h^2 - 2 b/h.
class SemiImplicitEuler : public TickScheme {
 public:
  explicit SemiImplicitEuler(SimbodyBody& body) : body_(body) {}
  dynamics::StepResult advance(const TickInput& input, RigidMotion& motion) override {
    const TickInput held = with_handle_held(input, input.handle.pose0, input.handle.twist0);
    const Mat6 M = body_.mass_matrix(motion.pose);
    Vec6 du = input.h * body_.right_hand_side(input.t0, motion, held);
    const Mat3 A = M.topLeftCorner<3, 3>() + input.h * gyroscopic_matrix(M, motion.twist);
    du.head<3>() = A.partialPivLu().solve(du.head<3>()).eval();
    du.tail<3>() /= body_.parameters().mass;
    move(motion, input.h, stacked(motion.twist) + du);
    return done(input);
  }

 private:
  SimbodyBody& body_;
};

}  // namespace

// Backward Euler with f linearised about (x0, u0):
//   u1 = u0 + h M^-1 f(x1, u1, handle at the end),   x1 = x0 + h u1;
//   (M + h (B + G) + h^2 K) (u1 - u0) = h (f0 - h K u0),   K = -df/dx, B = -df/du of coupling and contact.
// For a translation, and for a rotation about a principal axis, f is linear and the scheme equals backward
// Euler: k is not bounded.
StepEquation linearly_implicit_step(SimbodyBody& body, const TickInput& input, const RigidMotion& motion) {
  const double h = input.h;
  const TickInput held = with_handle_held(input, input.handle.pose1, input.handle.twist1);
  const Mat6 M = body.mass_matrix(motion.pose);
  // The contact record is evaluated at the end of the tick, too.
  const Vec6 f0 = body.right_hand_side(input.t0 + h, motion, held);

  const Mat6 K = coupling_stiffness(input.gains, motion.pose, input.handle.pose1) +
                 contact_stiffness(input.contact, motion.pose);
  Mat6 B = coupling_damping(input.gains) + contact_damping(input.contact);
  B.topLeftCorner<3, 3>() += gyroscopic_matrix(M, motion.twist);
  return {M + h * B + h * h * K, h * (f0 - h * (K * stacked(motion.twist)))};
}

namespace {

class LinearlyImplicitEuler : public TickScheme {
 public:
  explicit LinearlyImplicitEuler(SimbodyBody& body) : body_(body) {}
  dynamics::StepResult advance(const TickInput& input, RigidMotion& motion) override {
    const StepEquation step = linearly_implicit_step(body_, input, motion);
    const Vec6 du = step.A.partialPivLu().solve(step.r);
    move(motion, input.h, stacked(motion.twist) + du);
    const double scale = step.r.norm();
    return done(input, scale > 0.0 ? (step.A * du - step.r).norm() / scale : 0.0);
  }

 private:
  SimbodyBody& body_;
};

}  // namespace

std::unique_ptr<TickScheme> make_semi_implicit_euler(SimbodyBody& body) {
  return std::make_unique<SemiImplicitEuler>(body);
}
std::unique_ptr<TickScheme> make_linearly_implicit_euler(SimbodyBody& body) {
  return std::make_unique<LinearlyImplicitEuler>(body);
}

}  // namespace palpate::tool
