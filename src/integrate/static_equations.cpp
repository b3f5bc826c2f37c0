#include "integrate/static_equations.h"

#include <algorithm>
#include <cmath>

#include "core/clock.h"
#include "core/counters.h"
#include "core/finite.h"
#include "integrate/tuning.h"

namespace palpate::integrate {

using namespace dynamics;

bool StaticEquations::begin(double t1) {
  t0_ = state_.time();
  t1_ = t1;
  velocity_.setZero(state_.layout().u_size);
  rate_.resize(state_.layout().q_size);
  if (!force(t0_, state_.q(), unbalanced_)) return false;
  measure();
  const ScopedTimer timer(counters_.tangent_s);
  ++counters_.tangent_evaluations;
  base_q_ = q_ = state_.q();
  load = sigma = 0.0;
  assemble();
  return true;
}

/// Sets q to base_q_ moved by the displacement x along u-directions, with driven directions at time().
void StaticEquations::place(const double* x, VecX& q) {
  q_dot(state_.layout(), base_q_.data(), x, rate_.data());
  q = base_q_ + rate_;
  system_.impose(state_.layout(), time(), q.data(), velocity_.data());
  velocity_.setZero();
}

bool StaticEquations::force(double t, const VecX& q, VecX& f) {
  const ScopedTimer timer(counters_.force_s);
  ++counters_.force_evaluations;
  const StateView at = state_.view(t, q.data(), velocity_.data());
  system_.force(at, f);
  system_.reduce(at, f);
  return all_finite(f);
}

bool StaticEquations::residual(const double* x, double sigma_of_it, VecX& g) {
  place(x, q_);
  if (!force(time(), q_, g)) return false;
  g -= (1.0 - load) * unbalanced_;
  for (int dof : system_.driven_dofs()) g[dof] = 0.0;
  if (sigma_of_it > 0.0) {
    const StateView at = state_.view(time(), q_.data(), velocity_.data());
    system_.apply_mass(at, Eigen::Map<const VecX>(x, g.size()), inertia_);
    system_.reduce(at, inertia_);
    g -= sigma_of_it * inertia_;
  }
  return all_finite(g);
}

void StaticEquations::assemble_at(const double* x) {
  place(x, q_);
  assemble();
}

void StaticEquations::assemble() {
  system_.step_matrix(state_.view(time(), q_.data(), velocity_.data()), sigma, 0.0, 1.0, A_);
}

void StaticEquations::accept(const double* x) {
  place(x, base_q_);
  project(state_.layout(), base_q_.data());
  state_.q() = base_q_;
}

namespace {
/// Returns whether a direction of u is a rotation.
bool is_angle(const Block& b, int i) {
  return !b.angles_u.empty() && b.angles_u[static_cast<std::size_t>(i)] != 0;
}
}  // namespace

/// Sets the units of displacements and forces, by direction.
void StaticEquations::measure() {
  const Layout& layout = state_.layout();
  VecX largest = VecX::Zero(layout.u_size);
  for (const double t : {t0_, t1_}) add_forces(t, largest);
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  double far = 0.0;
  const auto reach = [&](const Vec3& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
    far = std::max(far, x.cwiseAbs().maxCoeff());
  };
  for (int i = 0; i < layout.node_count(); ++i) reach(state_.q().segment<3>(3 * i));
  for (const Block& b : layout.blocks)
    if (b.kind == BlockKind::kRigidBody && b.q_size == 7) reach(state_.q().segment<3>(b.q_offset + 4));
  const double arm = far > 0.0 ? (high - low).norm() : 0.0;
  VecX is_moment = VecX::Zero(layout.u_size);
  for (const Block& b : layout.blocks)
    for (int i = 0; b.kind != BlockKind::kNodes && i < b.u_size; ++i)
      is_moment[b.u_offset + i] = is_angle(b, i) ? 1.0 : 0.0;
  // Where all are zero any unit is valid.
  const auto positive = [](double x) { return x > 0.0 ? std::max(x, kSmallestLength) : 1.0; };
  force_ = (largest.array() * (1.0 - is_moment.array())).maxCoeff();
  const double moment = std::max((largest.array() * is_moment.array()).maxCoeff(), force_ * arm);
  far_ = far > 0.0 ? std::max(far, kSmallestLength) : 0.0;
  for (VecX* v : {&coordinate_, &displacement_scale_, &force_scale_}) v->resize(layout.u_size);
  for (int i = 0; i < layout.u_size; ++i) {
    const bool angle = is_moment[i] != 0.0;
    coordinate_[i] = angle ? 1.0 : far_;
    displacement_scale_[i] = 1.0 / (angle ? 1.0 : positive(far_));
    force_scale_[i] = 1.0 / positive(angle ? moment : force_);
  }
}

/// Computes the largest force of any one term on each free direction.
void StaticEquations::add_forces(double t, VecX& largest) {
  VecX f, q = state_.q();
  system_.impose(state_.layout(), t, q.data(), velocity_.data());
  velocity_.setZero();
  const StateView at = state_.view(t, q.data(), velocity_.data());
  for (const auto& term : system_.terms()) {
    f.setZero(state_.layout().u_size);
    term->add_force(at, f);
    system_.reduce(at, f);
    if (all_finite(f)) largest = largest.cwiseMax(f.cwiseAbs());
  }
}

/// The entries of a row of A_ sum to the negative contribution of driven directions, which are not in A_.
double StaticEquations::rounding() {
  absolute_ = A_;
  for (double& v : absolute_.body.values()) v = std::abs(v);
  absolute_.right = A_.right.cwiseAbs();
  absolute_.bottom = A_.bottom.cwiseAbs();
  absolute_.corner = A_.corner.cwiseAbs();
  absolute_.multiply(coordinate_, summands_);
  for (int dof : system_.driven_dofs()) summands_[dof] = 0.0;
  return tuning::kRounding * size_of(summands_);
}

double StaticEquations::stiffness_over_mass() {
  const StateView at = state_.view(time(), base_q_.data(), velocity_.data());
  system_.step_matrix(at, 0.0, 0.0, 1.0, A_);
  const VecX stiffness = diagonal();
  system_.step_matrix(at, 1.0, 0.0, 0.0, A_);
  const VecX mass = diagonal();
  double stiffest = 0.0, heaviest = 0.0, largest = 0.0;
  for (int i = 0; i < mass.size(); ++i) {
    if (system_.driven_mask()[static_cast<std::size_t>(i)] || !(mass[i] > 0.0)) continue;
    if (i < A_.nodal_size()) {
      stiffest = std::max(stiffest, stiffness[i]);
      heaviest = std::max(heaviest, mass[i]);
    } else {
      largest = std::max(largest, stiffness[i] / mass[i]);
    }
  }
  if (heaviest > 0.0) largest = std::max(largest, stiffest / heaviest);
  // Only loads: the stiffness that would balance them within the extent of the objects.
  return largest > 0.0 || !(heaviest * far_ > 0.0) ? largest : force_ / (heaviest * far_);
}

VecX StaticEquations::diagonal() const {
  VecX d(A_.size());
  for (int i = 0; i < A_.body.block_rows(); ++i)
    for (int k = 0; k < 3; ++k) d[3 * i + k] = std::abs(A_.body.block(A_.body.diagonal(i))[4 * k]);
  if (A_.border_size() > 0) d.tail(A_.border_size()) = A_.corner.diagonal().cwiseAbs();
  return d;
}

}  // namespace palpate::integrate
