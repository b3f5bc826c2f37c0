#include <Eigen/LU>

#include "simbody_body.h"
#include "tick_scheme.h"

namespace palpate::tool {
namespace {

/// x1 = x0 + h u1: along a straight line, and rotated by exp(h omega1), which is exact for a fixed axis.
void move(RigidMotion& motion, double h, const Vec6& u) {
  motion.twist = twist_of(u);
  motion.pose.rotation = (quaternion_of(h * motion.twist.angular) * motion.pose.rotation).normalized();
  motion.pose.translation += h * motion.twist.linear;
}

dynamics::StepResult done(const TickInput& input, double residual = 0.0) {
  return {dynamics::StepStatus::kOk, input.t0 + input.h, input.h, 1, 1, residual, {}};
}

// Gyroscopic term of both schemes, written in the body's axes (where I is constant) with L0 = I w0:
// f = -w x I w is taken as -w1 x L0, so that
//   I (w1 - w0) = -h w1 x L0   gives   w1 . I w1 = w1 . I w0 <= |w1|_I |w0|_I:
// it never adds energy, at any spin and any tick.  Taken explicitly it does, and diverges where the tool
// rotates by a radian in a tick.  As -w1 x L0 = L0 x w1, its matrix G = -[L0] is skew: the symmetric part of
// M + h (B + G) + h^2 K stays positive definite wherever those of K and B are semi-definite.  The components
// in the world axes of the tick's start serve for body axes: the rotation exp(h w1) does not change w1.
Mat3 gyroscopic_matrix(const Mat6& M, const Twist& twist) {
  return -cross_matrix(M.topLeftCorner<3, 3>() * twist.angular);
}

// (M + h G) (u1 - u0) = h f(x0, u0, handle at the start),  x1 = x0 + h u1.
// For one direction, x1 = z x0:
//   z^2 - (2 - (h^2 k + h b)/m) z + 1 - h b/m = 0;   |z| <= 1 until z = -1, that is k = 4 m/h^2 - 2 b/h.
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

// Backward Euler with f linearised about (x0, u0):
//   u1 = u0 + h M^-1 f(x1, u1, handle at the end),   x1 = x0 + h u1;
//   (M + h (B + G) + h^2 K) (u1 - u0) = h (f0 - h K u0),   K = -df/dx, B = -df/du of coupling and contact.
// In a translation, and in a rotation about a principal axis, f is linear and this is backward Euler itself:
// no bound on k.
class LinearlyImplicitEuler : public TickScheme {
 public:
  explicit LinearlyImplicitEuler(SimbodyBody& body) : body_(body) {}
  dynamics::StepResult advance(const TickInput& input, RigidMotion& motion) override {
    const double h = input.h;
    const TickInput held = with_handle_held(input, input.handle.pose1, input.handle.twist1);
    const Vec6 u0 = stacked(motion.twist);
    const Mat6 M = body_.mass_matrix(motion.pose);
    // the contact record is taken at the tick's end too
    const Vec6 f0 = body_.right_hand_side(input.t0 + h, motion, held);

    const Mat6 K = coupling_stiffness(input.gains, motion.pose, input.handle.pose1) +
                   contact_stiffness(input.contact, motion.pose);
    Mat6 B = coupling_damping(input.gains) + contact_damping(input.contact);
    B.topLeftCorner<3, 3>() += gyroscopic_matrix(M, motion.twist);
    const Mat6 A = M + h * B + h * h * K;
    const Vec6 rhs = h * (f0 - h * (K * u0));
    const Vec6 du = A.partialPivLu().solve(rhs);
    move(motion, h, u0 + du);

    const double scale = rhs.norm();
    return done(input, scale > 0.0 ? (A * du - rhs).norm() / scale : 0.0);
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
