#include "linear_problem.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>

#include "linear_term.h"
#include "palpate/core/error.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"

namespace palpate::stability {
namespace {

/// Returns the stiffness of a mesh at rest, in its free directions.
MatX rest_stiffness(const TetMesh& rest, const fem::Material& material, const std::vector<int>& free) {
  dynamics::State state;
  dynamics::BlockSpec spec;
  spec.name = "body";
  spec.q_size = spec.u_size = static_cast<int>(3 * rest.nodes.cols());
  const int id = state.insert(spec, rest.nodes.reshaped(), VecX::Zero(spec.u_size));
  fem::SoftBody body("body", rest, material, {}, id);
  dynamics::PatternBuilder pattern(state.layout());
  body.add_pattern(pattern);
  dynamics::BorderedMatrix K;
  K.body = pattern.build();
  body.add_tangent(state.view(), 1.0, 0.0, K);
  const MatX dense = K.to_dense();
  return dense(free, free);
}

using Complex = std::complex<double>;

/// Returns a(t) and a'(t) of a'' + 2 z w a' + w^2 a = 0 with a(0) = a0, a'(0) = 0, by the two roots s of
///     s^2 + 2 z w s + w^2.
/// Roots that nearly coincide are separated by a relative 1e-6, an error of about 1e-12. The small root of an
/// overdamped mode is w^2 over the large one, which avoids cancellation.
std::pair<double, double> oscillator(double w, double z, double a0, double t) {
  if (std::abs(z - 1.0) < 1e-12) z = 1.0 + 1e-12;
  const Complex root = std::sqrt(Complex(z * z - 1.0));
  const Complex s1 = -w * (z + root), s2 = z > 1.0 ? w * w / s1 : -w * (z - root);
  const Complex e1 = std::exp(s1 * t), e2 = std::exp(s2 * t);
  return {(a0 * (s1 * e2 - s2 * e1) / (s1 - s2)).real(), (a0 * s1 * s2 * (e2 - e1) / (s1 - s2)).real()};
}

}  // namespace

LinearProblem::LinearProblem(const TetMesh& rest, const fem::Material& material, double damping_ratio,
                             double clamp_below)
    : mesh_(rest), material_(material) {
  const VecX node_mass = fem::lumped_masses(rest, material.density);
  std::vector<double> mass;
  for (Eigen::Index node = 0; node < rest.nodes.cols(); ++node)
    for (int axis = 0; axis < 3; ++axis)
      if (rest.nodes(2, node) >= clamp_below) {
        free_.push_back(static_cast<int>(3 * node) + axis);
        mass.push_back(node_mass[node]);
      }
  mass_ = Eigen::Map<const VecX>(mass.data(), static_cast<Eigen::Index>(mass.size()));
  K_ = rest_stiffness(rest, material, free_);
  find_modes();
  beta_ = 2.0 * damping_ratio / omega_[0];
}

LinearProblem::LinearProblem(double omega, double damping_ratio, double contact_share)
    : mass_(VecX::Ones(3)),
      K_(MatX::Identity(3, 3) * omega * omega),
      beta_(2.0 * damping_ratio / omega),
      contact_share_(contact_share) {
  find_modes();
}

// Solves M^-1/2 K M^-1/2 in extended precision: with slivers in the mesh the squares of the frequencies span
// 1e13, and the lowest must not be lost in the rounding of the highest. The amplitude is 1/w_j with
// alternating signs: each mode has 1/2 J.
void LinearProblem::find_modes() {
  using MatL = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::Matrix<long double, Eigen::Dynamic, 1> root =
      mass_.cast<long double>().cwiseSqrt().cwiseInverse();
  const MatL symmetric = (0.5L * (K_ + K_.transpose()).cast<long double>()).eval();
  const Eigen::SelfAdjointEigenSolver<MatL> solver(root.asDiagonal() * symmetric * root.asDiagonal());
  PALPATE_CHECK(solver.info() == Eigen::Success && solver.eigenvalues()[0] > 0.0L, "no modes");
  omega_ = solver.eigenvalues().cwiseSqrt().cast<double>();
  phi_ = (root.asDiagonal() * solver.eigenvectors()).cast<double>();
  a0_ = omega_.cwiseInverse();
  for (Eigen::Index j = 1; j < a0_.size(); j += 2) a0_[j] *= -1.0;
  start_energy_ = 0.5 * static_cast<double>(omega_.size());
  const VecX q = phi_ * a0_;
  q_scale_ = q.norm() / std::sqrt(static_cast<double>(q.size()));
  u_scale_ = std::sqrt(2.0 * start_energy_ / mass_.sum());
}

double LinearProblem::fastest_rate() const {
  double fastest = 0.0;
  for (Eigen::Index j = 0; j < omega_.size(); ++j) {
    const double z = std::max(1.0, damping_ratio(j));
    fastest = std::max(fastest, omega_[j] * (z + std::sqrt(z * z - 1.0)));
  }
  return fastest;
}

double LinearProblem::condition() const { return std::pow(omega_[omega_.size() - 1] / omega_[0], 2); }

LinearProblem LinearProblem::by_elements() const {
  PALPATE_CHECK(!free_.empty(), "only a block has elements");
  LinearProblem out = *this;
  out.by_elements_ = true;
  return out;
}

VecX LinearProblem::Instance::displacement() const {
  if (free.empty()) return state.q();
  return (VecX(state.q()(free)) - rest) / amplitude;
}

VecX LinearProblem::Instance::velocity() const {
  if (free.empty()) return state.u();
  return VecX(state.u()(free)) / amplitude;
}

std::unique_ptr<LinearProblem::Instance> LinearProblem::start_elements() const {
  auto out = std::make_unique<Instance>();
  const auto size = static_cast<int>(mesh_.nodes.size());
  const VecX rest = mesh_.nodes.reshaped(), start = phi_ * a0_;
  out->free = free_;
  out->rest = rest(free_);
  out->amplitude = kOfElements *
                   (mesh_.nodes.rowwise().maxCoeff() - mesh_.nodes.rowwise().minCoeff()).maxCoeff() /
                   start.cwiseAbs().maxCoeff();
  VecX q = rest;
  q(free_) += out->amplitude * start;
  dynamics::BlockSpec spec;
  spec.name = "body";
  spec.q_size = spec.u_size = size;
  spec.q_scale = out->amplitude * q_scale_;
  spec.u_scale = out->amplitude * u_scale_;
  const int id = out->state.insert(spec, q, VecX::Zero(size));
  fem::Material material = material_;
  material.stiffness_damping = beta_;
  out->system.add(std::static_pointer_cast<dynamics::ForceTerm>(
      std::make_shared<fem::SoftBody>("body", mesh_, material, fem::SoftBodyOptions{}, id)));
  out->system.add(fem::make_lumped_mass(mesh_, material.density, id));
  std::vector<int> held;
  for (int i = 0; i < size; ++i)
    if (std::find(free_.begin(), free_.end(), i) == free_.end()) held.push_back(i);
  out->system.add(fem::make_fixed(held, rest(held)));
  out->system.prepare(out->state.view());
  return out;
}

std::unique_ptr<LinearProblem::Instance> LinearProblem::start() const {
  if (by_elements_) return start_elements();
  auto out = std::make_unique<Instance>();
  dynamics::BlockSpec spec;
  spec.name = "linear body";
  spec.q_size = spec.u_size = static_cast<int>(mass_.size());
  spec.q_scale = q_scale_;
  spec.u_scale = u_scale_;
  const int id = out->state.insert(spec, phi_ * a0_, VecX::Zero(mass_.size()));
  const auto add = [&](double share, bool contact) {
    out->system.add(std::static_pointer_cast<dynamics::ForceTerm>(
        std::make_shared<LinearTerm>(share * K_, beta_, contact)));
  };
  add(1.0 - contact_share_, false);
  if (contact_share_ > 0.0) add(contact_share_, true);
  out->system.add(std::static_pointer_cast<dynamics::InertiaTerm>(std::make_shared<DiagonalMass>(id, mass_)));
  out->system.prepare(out->state.view());
  return out;
}

// Evaluates the energy in modal coordinates, where it is a sum of squares: with a stiff K, q.K q would lose
// its small modes to rounding.
double LinearProblem::energy_of(const VecX& q, const VecX& u) const {
  const VecX a = phi_.transpose() * mass_.cwiseProduct(q);
  return 0.5 * (u.dot(mass_.cwiseProduct(u)) + omega_.cwiseProduct(a).squaredNorm());
}

double LinearProblem::energy(const Instance& run) const {
  return energy_of(run.displacement(), run.velocity()) / start_energy_;
}

double LinearProblem::error(const Instance& run, double t) const { return distance(run, modes_at(t)); }

LinearProblem::Points2 LinearProblem::modes_at_start() const { return modes_at(0.0); }

LinearProblem::Points2 LinearProblem::modes_at(double t) const {
  Points2 x(2, a0_.size());
  for (Eigen::Index j = 0; j < a0_.size(); ++j) {
    const auto [a, b] = oscillator(omega_[j], damping_ratio(j), a0_[j], t);
    x.col(j) << omega_[j] * a, b;
  }
  return x;
}

double LinearProblem::energy(const Points2& modes) const { return 0.5 * modes.squaredNorm() / start_energy_; }

double LinearProblem::distance(const Instance& run, const Points2& modes) const {
  const VecX a = modes.row(0).transpose().cwiseQuotient(omega_), b = modes.row(1).transpose();
  return std::sqrt(energy_of(run.displacement() - phi_ * a, run.velocity() - phi_ * b) / start_energy_);
}

double LinearProblem::from_rest(const Instance& run) const { return std::sqrt(energy(run)); }

double LinearProblem::largest_speed_rms() const {
  return std::sqrt(2.0 * start_energy_ / (mass_.minCoeff() * static_cast<double>(mass_.size())));
}

// WRMS <= 1 over 2n entries with the weights of error_weights.h allows
//     |dq| <= sqrt(2n) rtol atol_q q_scale,   |du| <= sqrt(2n) rtol (atol_u u_scale + rms u),
// and the energy of such an error is
//     2E = du.M du + dq.K dq <= m_max |du|^2 + w_max^2 m_max |dq|^2.
// (The sum of both bounds, of which only one can be reached, overestimates by up to 1.4.)
double LinearProblem::tolerance(const IntegratorSpec& spec, double speed) const {
  const double heaviest = mass_.maxCoeff(), count = 2.0 * static_cast<double>(mass_.size());
  const double dq = spec.atol_q * q_scale_, du = spec.atol_u * u_scale_ + speed;
  return spec.rtol * std::sqrt(count * heaviest * (du * du + std::pow(omega_[omega_.size() - 1] * dq, 2)) /
                               (2.0 * start_energy_));
}

}  // namespace palpate::stability
