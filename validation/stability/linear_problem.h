#pragma once
#include <memory>
#include <vector>

#include "palpate/dynamics/system.h"
#include "palpate/fem/material.h"
#include "palpate/mesh/mesh.h"

namespace palpate::stability {

/// Clamped elastic block at infinitesimal amplitude,
///     M q'' + beta K q' + K q = 0
/// in its displacements q, with the K of corotational tetrahedra at rest and lumped M. It is a direct sum of
/// oscillators K phi_j = w_j^2 M phi_j, so its motion is known exactly, for any step:
///     a_j'' + 2 z_j w_j a_j' + w_j^2 a_j = 0,   z_j = beta w_j/2,   q = sum a_j phi_j.
/// It starts at zero velocity with the same energy in every mode, so that an error in any mode is observed.
class LinearProblem {
 public:
  using Points2 = Eigen::Matrix<double, 2, Eigen::Dynamic>;
  /// Builds the problem from a mesh.
  /// @param damping_ratio z_1, ratio of the lowest mode
  /// @param clamp_below nodes with a smaller z [m] are held and excluded
  LinearProblem(const TetMesh& rest, const fem::Material& material, double damping_ratio, double clamp_below);
  /// Builds one oscillator with frequency `omega` [rad/s] in each of three directions, with unit mass.
  /// @param contact_share fraction of K in a separate contact term, which a method may split off
  LinearProblem(double omega, double damping_ratio, double contact_share = 0.0);

  const VecX& omega() const { return omega_; }  ///< [rad/s], ascending
  double damping_ratio(Eigen::Index mode) const { return 0.5 * beta_ * omega_[mode]; }
  double contact_share() const { return contact_share_; }
  /// Returns the largest modulus of an eigenvalue of y' = A y: w, or w (z + sqrt(z^2 - 1)) for an overdamped
  /// mode [1/s].
  double fastest_rate() const;
  double condition() const;  ///< Condition of K relative to M: (w_max/w_1)^2.

  /// Returns the same motion of a mesh computed by the element code: a soft body with its clamped nodes held,
  /// displaced by so little that it is linear to kOfElements.
  LinearProblem by_elements() const;
  bool is_by_elements() const { return by_elements_; }
  static constexpr double kOfElements = 1e-5;  ///< Initial displacement over the body's size.

  /// Copy of the System and of its initial State.
  struct Instance {
    dynamics::System system;
    dynamics::State state;
    std::vector<int> free{};  ///< Directions of the State that belong to the problem; empty: all.
    VecX rest{};              ///< Rest positions of these directions.
    double amplitude = 1.0;   ///< Displacements in the State over those of the problem.
    VecX displacement() const;
    VecX velocity() const;
  };
  std::unique_ptr<Instance> start() const;

  /// Returns kinetic and elastic energy over the initial energy.
  double energy(const Instance& run) const;
  double error(const Instance& run, double t) const;  ///< sqrt(E(y - y_exact(t))/E(y_start))
  double from_rest(const Instance& run) const;        ///< sqrt(E(y)/E(y_start))
  /// Returns the initial [w a; a'] of each mode, one per column: |x|^2/2 is its energy.
  Points2 modes_at_start() const;
  Points2 modes_at(double t) const;           ///< Modes of the exact motion.
  double energy(const Points2& modes) const;  ///< Over the initial energy.
  /// Returns sqrt(E(y - y_modes)/E(y_start)).
  double distance(const Instance& run, const Points2& modes) const;
  /// Returns the largest error, as defined by error(), that WRMS <= 1 admits for weights of `rtol` and a root
  /// mean square `speed_rms` of u; derived in linear_problem.cpp.
  double tolerance(const IntegratorSpec& spec, double speed_rms) const;
  double largest_speed_rms() const;  ///< Largest root mean square of u at the initial energy [m/s].

 private:
  void find_modes();
  std::unique_ptr<Instance> start_elements() const;
  double energy_of(const VecX& q, const VecX& u) const;

  TetMesh mesh_;  ///< Mesh of a block.
  fem::Material material_;
  std::vector<int> free_;  ///< Directions of its nodes that are not held.
  bool by_elements_ = false;
  VecX mass_;  ///< One per direction [kg].
  MatX K_;
  double beta_ = 0.0, contact_share_ = 0.0;
  VecX omega_;
  MatX phi_;  ///< phi^T M phi = 1
  VecX a0_;   ///< Initial modal amplitudes.
  double start_energy_ = 0.0;
  double q_scale_ = 1.0, u_scale_ = 1.0;
};

}  // namespace palpate::stability
