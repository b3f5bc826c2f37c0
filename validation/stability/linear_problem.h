#pragma once
#include <memory>
#include <vector>

#include "palpate/dynamics/system.h"
#include "palpate/fem/material.h"
#include "palpate/mesh/mesh.h"

namespace palpate::stability {

/// A clamped elastic block at infinitesimal amplitude,
///     M q'' + beta K q' + K q = 0
/// in its displacements q, with the K of corotational tetrahedra at rest and lumped M.  It is a direct sum of
/// oscillators K phi_j = w_j^2 M phi_j, so its motion is known exactly, whatever the step:
///     a_j'' + 2 z_j w_j a_j' + w_j^2 a_j = 0,   z_j = beta w_j/2,   q = sum a_j phi_j.
/// It starts at zero velocity with the same energy in every mode, so that no mode can misbehave unseen.
class LinearProblem {
 public:
  using Points2 = Eigen::Matrix<double, 2, Eigen::Dynamic>;
  /// @param damping_ratio  z_1, of the lowest mode  @param clamp_below  nodes with a smaller z [m] are
  ///   held, and left out
  LinearProblem(const TetMesh& rest, const fem::Material& material, double damping_ratio, double clamp_below);
  /// One oscillator of frequency `omega` [rad/s] in each of three directions, unit mass.
  /// @param contact_share  of K that is a term of its own, a contact: what a method may split off
  LinearProblem(double omega, double damping_ratio, double contact_share = 0.0);

  const VecX& omega() const { return omega_; }  ///< [rad/s], ascending
  double damping_ratio(Eigen::Index mode) const { return 0.5 * beta_ * omega_[mode]; }
  double contact_share() const { return contact_share_; }
  /// Largest modulus of an eigenvalue of y' = A y: w, or w (z + sqrt(z^2 - 1)) of an overdamped mode [1/s].
  double fastest_rate() const;
  double condition() const;  ///< of K against M: (w_max/w_1)^2

  /// The same motion, of a mesh, made by the elements themselves: a soft body with its clamped nodes held,
  /// displaced so little that it is linear to kOfElements.
  LinearProblem by_elements() const;
  bool is_by_elements() const { return by_elements_; }
  static constexpr double kOfElements = 1e-5;  ///< displacement at the start, over the body's size

  /// A copy of the System and of its State at the start.
  struct Instance {
    dynamics::System system;
    dynamics::State state;
    std::vector<int> free{};  ///< directions of the State that are the problem's; empty: all
    VecX rest{};              ///< of those
    double amplitude = 1.0;   ///< displacements in the State over those of the problem
    VecX displacement() const;
    VecX velocity() const;
  };
  std::unique_ptr<Instance> start() const;

  /// kinetic and elastic energy over that of the start
  double energy(const Instance& run) const;
  double error(const Instance& run, double t) const;  ///< sqrt(E(y - y_exact(t))/E(y_start))
  double from_rest(const Instance& run) const;        ///< sqrt(E(y)/E(y_start))
  /// The start in each mode's [w a; a'], one a column: |x|^2/2 is its energy.
  Points2 modes_at_start() const;
  Points2 modes_at(double t) const;           ///< of the exact motion
  double energy(const Points2& modes) const;  ///< over that of the start
  /// sqrt(E(y - y_modes)/E(y_start))
  double distance(const Instance& run, const Points2& modes) const;
  /// Largest error, measured as error() does, that WRMS <= 1 admits for weights of `rtol` and a root mean
  /// square `speed_rms` of u; derived in linear_problem.cpp.
  double tolerance(const IntegratorSpec& spec, double speed_rms) const;
  double largest_speed_rms() const;  ///< root mean square of u that the energy of the start allows [m/s]

 private:
  void find_modes();
  std::unique_ptr<Instance> start_elements() const;
  double energy_of(const VecX& q, const VecX& u) const;

  TetMesh mesh_;  ///< of a block
  fem::Material material_;
  std::vector<int> free_;  ///< directions of its nodes that are not held
  bool by_elements_ = false;
  VecX mass_;  ///< one a direction [kg]
  MatX K_;
  double beta_ = 0.0, contact_share_ = 0.0;
  VecX omega_;
  MatX phi_;  ///< phi^T M phi = 1
  VecX a0_;   ///< modal amplitudes at the start
  double start_energy_ = 0.0;
  double q_scale_ = 1.0, u_scale_ = 1.0;
};

}  // namespace palpate::stability
