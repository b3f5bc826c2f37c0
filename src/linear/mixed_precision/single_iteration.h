#pragma once
#include <algorithm>

#include "linear/mixed_precision/energy_bound.h"
#include "linear/mixed_precision/rigid_mode_coarse_space.h"
#include "linear/mixed_precision/single_matrix.h"

namespace palpate::linear {

/// Conjugate gradients in single precision on (scale A) d = r, for a residual r of order one in the units of
/// the copy. The preconditioner is block Jacobi plus, where available, the rigid-mode coarse space. The
/// caller supplies the true magnitude of r and decides when the error is small enough.
class SingleIteration {
 public:
  SingleIteration(const NodeKernels& kernels, ClusterTeam& team, const SingleMatrix& matrix,
                  const RigidModeCoarseSpace& clusters)
      : kernels_(kernels), team_(team), matrix_(matrix), clusters_(clusters) {}

  /// Allocates memory for the copy's order.
  void prepare();
  Singles& residual() { return r_; }
  /// Whether a correction was found; correct() adds it: x += by d on nodes [first, last), where x begins with
  /// node `first`.
  bool moved() const { return moved_; }
  void correct(double by, double* x, int first, int last) const {
    kernels_.correct(by, d_.data(), last_length_, p_.data(), x, first, last);
  }
  /// Sets d = 0 and continues the search.
  void clear_correction();

  /// Begins the error bound of a new solve. `start` as in EnergyBound::begin.
  void begin(double start) { bound_.begin(start); }
  /// Ends the error bound of a solve.
  void end() { bound_.end(); }
  bool first() const { return bound_.first(); }
  /// Whether the error is below rtol of the solution's lower bound, or otherwise allowed, for rho = r . P^-1
  /// r in units of the matrix.
  bool reached(double rho, double rtol) const {
    return bound_.error(rho) <= std::max(requested(rtol), share_ * share_ * bound_.gained()) && rho <= floor_;
  }
  /// Upper bound of the squared error of the solution, and lower bound of the squared solution, both in the
  /// energy norm, for rho in units of the matrix.
  double error(double rho) const { return bound_.error(rho); }
  double solution() const { return bound_.solution(); }
  /// Also accepts an error whose square is at most this.
  void allow(double square) { allowed_ = square; }
  /// Also accepts an error of at most this fraction of the distance from the start of the solve.
  void allow_share(double share) { share_ = share; }
  /// Whether the error is below rtol of the solution or allowed by allow(); allow_share() is ignored.
  bool accurate(double rho, double rtol) const {
    return bound_.error(rho) <= requested(rtol) && rho <= floor_;
  }
  /// Sets an upper limit of rho at the end, in addition to the error bound.
  void set_floor(double rho) { floor_ = rho; }

  /// Computes z = P^-1 r, where set_residual(first node, last node) sets r range by range over all nodes;
  /// returns r . z.
  template <class Set>
  double precondition(Set&& set_residual) {
    team_.for_each_cluster([&](std::size_t cluster, int first, int last) {
      set_residual(first, last);
      precondition(cluster, first, last);
    });
    coarse();
    return squared_residual();
  }
  /// Discards the last direction and the correction.
  void restart();
  /// Iterates from z = P^-1 r until rho falls to `spent` or reached() holds for rtol.
  /// @param rho  In: result of precondition(); out: value at the end.
  /// @param beta  Coefficient of the last direction in the first new one.
  /// @param spent  Value of rho at which the residual must be recomputed.
  /// @param unit  Matrix energy per unit of rho.
  /// @param left  Most iterations.
  /// @param steps  Out: iterations.
  dynamics::SolveStatus reduce(double& rho, double beta, double spent, double unit, double rtol, int left,
                               int& steps);
  /// Minimises the error along the last direction after the residual was recomputed: rounding leaves a
  /// component that is not orthogonal to that direction, on which the length of the next step relies. Returns
  /// false if there is no last direction.
  bool minimise_along_last();
  /// Applies the preconditioner, z = P^-1 r, and returns the coefficient beta = -(z . A p)/(p . A p) of the
  /// last search direction p that makes the next one A-orthogonal to it.
  double orthogonal_to_last();

 private:
  double requested(double rtol) const { return std::max(rtol * rtol * bound_.solution(), allowed_); }
  bool coarse_on() const { return clusters_.ready(); }
  void precondition(std::size_t cluster, int first, int last);
  double gather(std::size_t cluster);
  void coarse();
  double squared_residual() const;
  void step_direction(float beta, bool first_one);
  template <class Follow>
  void over_motions(std::size_t cluster, int first, int last, Follow&& follow) const;

  const NodeKernels& kernels_;
  ClusterTeam& team_;
  const SingleMatrix& matrix_;
  const RigidModeCoarseSpace& clusters_;
  Singles d_, r_, z_, p_, q_;
  Singles y_, w_;   ///< force and moment, and motion, per cluster
  Singles pieces_;  ///< motion of each piece
  double pq_ = 0.0, floor_ = 0.0, allowed_ = 0.0, share_ = 0.0;
  bool moved_ = false;        ///< d_ + last_length_ p_ is the correction found
  float last_length_ = 0.0f;  ///< length of the last step, not yet in d_
  EnergyBound bound_;
  std::vector<double> partial_, partial_pq_;  ///< sums per cluster and per part
};

}  // namespace palpate::linear
