#include <Eigen/Cholesky>

#include <algorithm>

#include "contact/grasp.h"
#include "contact/reduced_contact_model.h"
#include "contact/sample_math.h"

namespace palpate::contact {

// One tick, from t0 to t1 = t0 + h, of tool and reduced bodies together by linearly implicit Euler. Tool and
// bodies are first extrapolated with their present velocities, to (x_p, v) and q_p = q0 + h z0, z = q'. In
// that state each point i has its force F_i on the tool with K_i = -dF/dx_rel, D_i = -dF/dv_rel. A point that
// separates within the tick no longer presses there, and one that comes into contact does. Z_i and V_i are
// the tool's maps to the point (tangent.cpp), P_i the modes there. If the tool ends at x_p + dx with v + dv,
// and the bodies with z_p + dz, q_p + h dz, then
//     F_i(t1) = F_i - K_i (Z_i dx - h P_i dz) - D_i (V_i dx + Z_i dv - P_i dz),
// and q' of the model follows, with S_i = h K_i + D_i, from
//     A dz = r + h sum P_i^T (K_i Z_i + D_i V_i) dx + h sum P_i^T D_i Z_i dv,
//     A = 1 + h D + h^2 diag(k) + h sum P_i^T S_i P_i,
//     r = h (f(t1) - D z_p - k q_p - sum P_i^T F_i) - (z_p - z0),        z_p = z0.
// The contact wrench on the tool is sum Z_i^T F_i(t1); its derivatives with respect to dx and dv, including
// those of the arms, are J and B. The record is passed to the tool's integrator, which determines dx and dv,
// and then dz follows. Both sides receive the same forces: momentum is conserved up to rounding.
//
// A held point (grasp.cpp) has K, D and F with P in place of its maps to a sample, and its force rotates with
// the tool: in the tool's moment r x F, r changes with the bodies, by h P dz, and F rotates.
//
// A sticking point has a spring in parallel to the friction damper (friction_anchors.cpp). Its deflection is
// that at the model's time plus the relative displacement of the material points of tool and bodies since
// then, evaluated at the tick's start and held constant within the tick: as in a step of one linear solve it
// is multiplied by no less than 1 - h/tau, so that in a tick longer than tau the length h replaces tau.
//
// A is symmetric and positive definite at any h: K_i and D_i exclude the change of friction with pressure,
// and friction is affine about a guess of the tick's end (friction.cpp). The integrator of the tool finds the
// end to which the record leads, and the guess is improved until friction obeys the law there.
//
// The sums are most of a tick's work. They are evaluated with the number of the model's modes, rounded up,
// and with P transposed, so that all loops run along the modes, which are contiguous.
namespace {

constexpr int kModes = ReducedContactModel::kMostModes;
using Modes = Eigen::Matrix<double, kModes, 1>;
using ModesByModes = Eigen::Matrix<double, kModes, kModes>;
using ModesBySix = Eigen::Matrix<double, kModes, 6>;
using ModesByThree = Eigen::Matrix<double, kModes, 3>;  ///< P^T
using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// Touching point of the present tick, in the extrapolated state of tool and bodies.
struct TickPoint {
  bool touches = false;
  ContactSample sample;
  SampleMotion motion;
};

PressureLaw law_of_ticks(ContactSpec spec) {
  spec.friction_tangent = FrictionTangent::kSecant;
  return pressure_law(spec);
}

}  // namespace

struct ReducedContactStepper::Impl {
  std::vector<PressureLaw> laws;
  ReducedContactModel model;
  std::array<ModesByThree, ReducedContactModel::kMostPoints> modes;  ///< P^T per point.
  /// Per point with friction: guess of the tick's end, and the motion at which it was linearised.
  std::array<FrictionGuess, ReducedContactModel::kMostPoints> guess;
  std::array<TickPoint, ReducedContactModel::kMostPoints> tick_point;
  int solves = 0;
  Modes q = Modes::Zero(), z = Modes::Zero();
  Pose of_model;                  ///< Pose of the tool at the model's time.
  double pressed_by_model = 0.0;  ///< Sum of area times depth at the model's time [m^3].
  // Present tick.
  double h = 0.0, t1 = 0.0;
  Pose start;                ///< Pose of the tool at the tick's start.
  dynamics::RigidMotion at;  ///< x_p, v.
  Modes dz = Modes::Zero();
  ModesBySix dz_dx = ModesBySix::Zero(), dz_dv = ModesBySix::Zero();
  int pressing = 0;

  /// Linearises with the first N modes.
  template <int N>
  void linearise(dynamics::LinearisedContact& out);
};

ReducedContactStepper::ReducedContactStepper(const std::vector<ContactSpec>& contacts)
    : impl_(std::make_unique<Impl>()) {
  for (const ContactSpec& spec : contacts) impl_->laws.push_back(law_of_ticks(spec));
}
ReducedContactStepper::~ReducedContactStepper() = default;
ReducedContactStepper::ReducedContactStepper(ReducedContactStepper&&) noexcept = default;

int ReducedContactStepper::pressing() const { return impl_->pressing; }

bool ReducedContactStepper::has_friction() const {
  const Impl& m = *impl_;
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.model.points); ++i) {
    const ReducedContactModel::Point& point = m.model.point[i];
    if (point.held_stiffness == 0.0 && m.tick_point[i].touches &&
        m.laws[static_cast<std::size_t>(point.pair)].friction > 0.0)
      return true;
  }
  return false;
}

VecX ReducedContactStepper::rates() const { return impl_->z; }

void ReducedContactStepper::adopt(const ReducedContactModel& model) {
  Impl& m = *impl_;
  m.model = model;
  const auto& p = model.tool;
  m.of_model = {Quat(p[0], p[1], p[2], p[3]), Vec3(p[4], p[5], p[6])};
  m.q.setZero();
  m.z.setZero();
  m.dz_dx.setZero();
  m.dz_dv.setZero();
  m.dz.setZero();
  m.pressed_by_model = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.points); ++i) {
    const ReducedContactModel::Point& point = model.point[i];
    const Vec3 arm = m.of_model.rotation * vec(point.offset) + vec(point.slide);
    const double gap = vec(point.normal).dot(m.of_model.translation + arm - vec(point.place));
    if (point.held_stiffness == 0.0) m.pressed_by_model += point.area * std::max(0.0, -gap);
    m.modes[i] = Eigen::Map<const Eigen::Matrix<double, 3, kModes>>(model.point[i].modes.data()).transpose();
  }
}

void ReducedContactStepper::archive(Archive& a) {
  Impl& m = *impl_;
  ReducedContactModel model = m.model;
  a.bytes("model", model);
  if (a.is_restoring()) adopt(model);
  a("q", m.q);
  a("z", m.z);
}

namespace {

/// Extrapolated state of tool and bodies, and the sums over the points in it.
template <int N>
struct Sums {
  using Modes = Eigen::Matrix<double, N, 1>;
  using ModesByModes = Eigen::Matrix<double, N, N>;
  using ModesBySix = Eigen::Matrix<double, N, 6>;
  using ModesByThree = Eigen::Matrix<double, N, 3>;

  const dynamics::RigidMotion& tool;  ///< x_p, v.
  const Pose &start, &of_model;       ///< Pose of the tool at the tick's start and at the model's time.
  double tau, h;
  Modes q, z;
  Mat3 R = tool.pose.rotation.toRotationMatrix(), R_start = start.rotation.toRotationMatrix(),
       R_model = of_model.rotation.toRotationMatrix();

  ModesByModes A = ModesByModes::Zero();
  Modes r = Modes::Zero();
  ModesBySix by_x = ModesBySix::Zero(), by_v = ModesBySix::Zero(), S_by_Z = ModesBySix::Zero();
  Vec6 wrench = Vec6::Zero();
  Mat6 K = Mat6::Zero(), B = Mat6::Zero();
  int pressing = 0;
  double pressed = 0.0;  ///< Sum of area times depth [m^3].

  /// Adds one contact point.
  /// @param P_t  P^T of the point  @param guess  guess of its friction; created if there is none
  void add_touching(const ReducedContactModel::Point& point, const ModesByThree& P_t, const PressureLaw& law,
                    TickPoint& out, FrictionGuess& guess);
  /// Adds one held point.
  void add_held(const ReducedContactModel::Point& point, const ModesByThree& P_t);

 private:
  Vec3 place(const ReducedContactModel::Point& point, const ModesByThree& P_t) const {
    return vec(point.place) + tau * vec(point.velocity) + P_t.transpose() * q;
  }
  Vec3 velocity(const ReducedContactModel::Point& point, const ModesByThree& P_t) const {
    return vec(point.velocity) + P_t.transpose() * z;
  }
  /// Returns the deflection of the friction spring at the tick's start.
  Vec3 deflection(const ReducedContactModel::Point& point, const Vec3& place_then,
                  const PressureLaw& law) const {
    const Vec3 arm = R_model * vec(point.offset) + vec(point.slide), n = vec(point.normal);
    const Vec3 way = start.translation + R_start * (R_model.transpose() * arm) - place_then -
                     (of_model.translation + arm - vec(point.place));
    const Vec3 u = vec(point.deflection) + way, across = u - n.dot(u) * n;
    const double longest = law.retardation * law.regularisation, length = across.norm();
    return length > longest ? Vec3(longest / length * across) : across;
  }
  /// Adds the terms common to contact points and held points.
  /// @param Kx, Dv  -dF with respect to the tool's pose and twist
  void add(const ModesByThree& P_t, const Mat36& Z, const Vec3& arm, const Vec3& F, const Mat3& S,
           const Mat36& Kx, const Mat36& Dv);
};

template <int N>
void Sums<N>::add(const ModesByThree& P_t, const Mat36& Z, const Vec3& arm, const Vec3& F, const Mat3& S,
                  const Mat36& Kx, const Mat36& Dv) {
  const ModesByThree PS = P_t.lazyProduct(S);  // S is symmetric.
  A += (h * PS).lazyProduct(P_t.transpose());
  by_x += P_t.lazyProduct(Kx);
  by_v += P_t.lazyProduct(Dv);
  S_by_Z += PS.lazyProduct(Z);
  r -= P_t.lazyProduct(F);
  wrench.head<3>() += arm.cross(F);
  wrench.tail<3>() += F;
  K.noalias() += Z.transpose() * Kx;
  B.noalias() += Z.transpose() * Dv;
}

template <int N>
void Sums<N>::add_touching(const ReducedContactModel::Point& point, const ModesByThree& P_t,
                           const PressureLaw& law, TickPoint& out, FrictionGuess& guess) {
  const Vec3 slide = vec(point.slide), rotating = R * vec(point.offset), arm = rotating + slide;
  ContactSample& sample = out.sample;
  sample.normal = vec(point.normal);
  sample.area = point.area;
  SampleMotion& motion = out.motion;
  motion.a = {tool.pose.translation + arm, tool.twist.at(arm), arm, rotating};
  motion.b = {place(point, P_t), velocity(point, P_t), Vec3::Zero(), Vec3::Zero()};
  motion.gap = sample.normal.dot(motion.a.x - motion.b.x);
  out.touches = motion.gap < 0.0;
  if (!out.touches) return;
  pressed -= sample.area * motion.gap;
  motion.rate = sample.normal.dot(motion.a.v - motion.b.v);
  if (law.friction > 0.0 && law.retardation > 0.0)
    sample.deflection_rate =
        deflection(point, motion.b.x - h * motion.b.v, law) / std::max(law.retardation, h);
  if (law.friction > 0.0 && guess.v_r == 0.0) {
    const SampleEnd now = sample_end(sample, motion, law, {});
    guess = first_guess(now.limit, now.v, law.regularisation);
  }
  const SampleForce s =
      law.friction > 0.0 ? sample_force_and_tangent(sample, motion, law, friction_line(guess, sample.normal))
                         : sample_force_and_tangent(sample, motion, law, true);
  if (s.force.isZero(0.0) && s.D.isZero(0.0)) return;
  ++pressing;
  Mat36 Z;
  Z << -cross_matrix(arm), Mat3::Identity();
  Mat36 Kx = s.K * Z;
  Kx.leftCols<3>().noalias() -= s.D * (cross_matrix(tool.twist.angular) * cross_matrix(rotating));
  add(P_t, Z, arm, s.force, h * s.K + s.D, Kx, s.D * Z);
  K.topLeftCorner<3, 3>().noalias() -= cross_matrix(s.force) * cross_matrix(rotating);
}

template <int N>
void Sums<N>::add_held(const ReducedContactModel::Point& point, const ModesByThree& P_t) {
  const Vec3 arm = place(point, P_t) - tool.pose.translation;
  const BondForce b =
      bond_force(R * vec(point.offset) - arm, R * vec(point.normal), arm,
                 tool.twist.at(arm) - velocity(point, P_t), point.held_stiffness, point.held_damping);
  Mat36 Z;
  Z << -cross_matrix(arm), Mat3::Identity();
  const Mat3 F = cross_matrix(b.elastic);
  Mat36 Kx = b.K * Z;
  Kx.leftCols<3>() += F;
  add(P_t, Z, arm, b.force, h * b.K + b.D, Kx, b.D * Z);
  S_by_Z.template leftCols<3>() += h * P_t.lazyProduct(F);
  // The term Z^T [F]x dtheta from add() contains the part [r]x [F]x of -dM = ([M]x + [F]x [r]x) dtheta - [F]x
  // dp.
  const Mat3 turn = cross_matrix(arm);
  K.topLeftCorner<3, 3>() += cross_matrix(arm.cross(b.elastic)) + F * turn - turn * F;
  K.topRightCorner<3, 3>() -= F;
}

}  // namespace

template <int N>
void ReducedContactStepper::Impl::linearise(dynamics::LinearisedContact& out) {
  const double tau = t1 - model.time;
  using OfModes = Eigen::Matrix<double, N, 1>;
  const OfModes z_p = z.head<N>(), q_p = q.head<N>() + h * z_p;
  const auto damping = Eigen::Map<const ModesByModes>(model.damping.data()).topLeftCorner<N, N>();
  const Eigen::Map<const OfModes> stiffness(model.stiffness.data()), force(model.force.data()),
      rate(model.force_rate.data());
  Sums<N> sums{.tool = at, .start = start, .of_model = of_model, .tau = tau, .h = h, .q = q_p, .z = z_p};
  sums.A = h * damping;
  sums.A.diagonal() += OfModes::Ones() + h * h * stiffness;
  sums.r = force + tau * rate - damping * z_p - stiffness.cwiseProduct(q_p);
  for (std::size_t i = 0; i < static_cast<std::size_t>(model.points); ++i) {
    const ReducedContactModel::Point& point = model.point[i];
    const Eigen::Matrix<double, N, 3> P_t = modes[i].topRows<N>();
    if (point.held_stiffness > 0.0)
      sums.add_held(point, P_t);
    else
      sums.add_touching(point, P_t, laws[static_cast<std::size_t>(point.pair)], tick_point[i], guess[i]);
  }
  if (pressed_by_model > 0.0) {
    const double share = std::min(1.0, sums.pressed / pressed_by_model);
    sums.wrench += share * Eigen::Map<const Vec6>(model.missing_wrench.data());
    sums.r += share * Eigen::Map<const OfModes>(model.missing_load.data());
  }
  ++solves;
  pressing = sums.pressing;
  const Eigen::LLT<Eigen::Matrix<double, N, N>> factor(sums.A);
  dz.head<N>() = factor.solve(h * sums.r);
  dz_dx.topRows<N>() = factor.solve(h * sums.by_x);
  dz_dv.topRows<N>() = factor.solve(h * sums.by_v);
  Eigen::Map<Vec6>(out.F0.data()) = sums.wrench + sums.S_by_Z.transpose() * dz.head<N>();
  Eigen::Map<RowMajor6>(out.J.data()) = sums.S_by_Z.transpose() * dz_dx.topRows<N>() - sums.K;
  Eigen::Map<RowMajor6>(out.B.data()) = sums.S_by_Z.transpose() * dz_dv.topRows<N>() - sums.B;
}

// At the end to which the record leads, the displacement of each point relative to the bodies and the
// change of its relative velocity since the linearisation are
//     Z_i dx - h P_i dz,   V_i dx + Z_i dv - P_i dz.
// The pressure and the sliding velocity there are the next guess.
bool ReducedContactStepper::update_friction(const dynamics::RigidMotion& end, double tolerance) {
  Impl& m = *impl_;
  const Vec6 dx = pose_difference(m.at.pose, end.pose);
  Vec6 dv;
  dv << end.twist.angular - m.at.twist.angular, end.twist.linear - m.at.twist.linear;
  const Modes dz = m.dz + m.dz_dx * dx + m.dz_dv * dv;
  double worst = 0.0;
  for (std::size_t pair = 0; pair < m.laws.size(); ++pair) {
    const PressureLaw& law = m.laws[pair];
    if (law.friction == 0.0) continue;
    FrictionError error;
    for (std::size_t i = 0; i < static_cast<std::size_t>(m.model.points); ++i) {
      const ReducedContactModel::Point& point = m.model.point[i];
      const TickPoint& at = m.tick_point[i];
      if (point.pair != static_cast<int>(pair) || point.held_stiffness > 0.0 || !at.touches) continue;
      const Vec3 turn = dx.head<3>(), answer = m.modes[i].transpose() * dz;
      const PointMotion& mine = at.motion.a;
      const SampleStep step{turn.cross(mine.arm) + dx.tail<3>() - m.h * answer,
                            dv.head<3>().cross(mine.arm) + dv.tail<3>() +
                                m.at.twist.angular.cross(turn.cross(mine.rotating)) - answer};
      const SampleEnd there = sample_end(at.sample, at.motion, law, step);
      const FrictionLine line = friction_line(m.guess[i], at.sample.normal);
      const Vec3 taken = line.constant - line.D * there.v;
      error.add(taken, there.limit, there.v, law.regularisation);
      end_solve(m.guess[i], there.limit, there.v, taken);
    }
    worst = std::max(worst, error.relative());
  }
  if (worst <= (tolerance > 0.0 ? tolerance : kFrictionTolerance) || m.solves >= kFrictionSolves) return true;
  move_guesses(std::span(m.guess).first(static_cast<std::size_t>(m.model.points)), m.solves);
  return false;
}

dynamics::LinearisedContact ReducedContactStepper::linearise(double t1, double h,
                                                             const dynamics::RigidMotion& tool) {
  Impl& m = *impl_;
  m.h = h;
  m.solves = 0;
  std::fill_n(m.guess.begin(), m.model.points, FrictionGuess());
  m.start = tool.pose;
  m.at.twist = tool.twist;
  m.at.pose.rotation = (quaternion_of(h * tool.twist.angular) * tool.pose.rotation).normalized();
  m.at.pose.translation = tool.pose.translation + h * tool.twist.linear;
  m.t1 = t1;
  return relinearise();
}

dynamics::LinearisedContact ReducedContactStepper::relinearise() {
  Impl& m = *impl_;
  dynamics::LinearisedContact out;
  if (m.model.modes <= 4)
    m.linearise<4>(out);
  else if (m.model.modes <= 8)
    m.linearise<8>(out);
  else
    m.linearise<kModes>(out);
  out.time = m.t1;
  const Quat& rotation = m.at.pose.rotation;
  const Vec3& x = m.at.pose.translation;
  out.x0 = {rotation.w(), rotation.x(), rotation.y(), rotation.z(), x.x(), x.y(), x.z()};
  Eigen::Map<Vec6>(out.v0.data()) << m.at.twist.angular, m.at.twist.linear;
  out.source = dynamics::LinearisedContact::Source::kPoints;
  out.samples = m.pressing;
  return out;
}

void ReducedContactStepper::follow(const dynamics::RigidMotion& tool) {
  Impl& m = *impl_;
  Vec6 dv;
  dv << tool.twist.angular - m.at.twist.angular, tool.twist.linear - m.at.twist.linear;
  m.z += m.dz + m.dz_dx * pose_difference(m.at.pose, tool.pose) + m.dz_dv * dv;
  m.q += m.h * m.z;
}

}  // namespace palpate::contact
