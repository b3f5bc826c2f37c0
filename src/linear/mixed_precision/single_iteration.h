#pragma once
#include <algorithm>

#include "linear/mixed_precision/energy_bound.h"
#include "linear/mixed_precision/rigid_mode_coarse_space.h"
#include "linear/mixed_precision/single_matrix.h"

namespace palpate::linear {

/// The iteration of conjugate gradients in single precision: (A scale) d = r, from a residual r of order one,
/// in the units of the copy.  The preconditioner is the inverse diagonal blocks, and rigid clusters where
/// there are some.  Who drives it says how large r really is, and when the error is small enough.
class SingleIteration {
 public:
  SingleIteration(const NodeKernels& kernels, ClusterTeam& team, const SingleMatrix& matrix,
                  const RigidModeCoarseSpace& clusters)
      : kernels_(kernels), team_(team), matrix_(matrix), clusters_(clusters) {}

  void prepare();
  Singles& residual() { return r_; }
  /// Whether it found something: x += by d on nodes [first, last), where x begins with node `first`.
  bool moved() const { return moved_; }
  void correct(double by, double* x, int first, int last) const {
    kernels_.correct(by, d_.data(), last_length_, p_.data(), x, first, last);
  }
  /// d = 0, and the search goes on.
  void clear_correction();

  /// The bound of a new solve.  @param start  as EnergyBound::begin
  void begin(double start);
  void end();
  bool first() const { return bounds_[0].first(); }
  /// Whether the error is below rtol of the solution's lower bound, for rho = r . P^-1 r in units of the
  /// matrix.
  bool reached(double rho, double rtol) const { return reached(bounds_[0], rho, rtol); }
  /// Upper bound of the error of the solution, squared, and lower bound of the solution's own square, for
  /// such a rho.
  double error(double rho) const { return bounds_[0].error(rho); }
  double solution() const { return bounds_[0].solution(); }
  /// An error whose square is no more than this is small enough too.
  void allow(double square) { allowed_ = square; }
  /// So is one that is no more than this share of the way from the start of the solve.
  void allow_share(double share) { share_ = share; }
  /// Whether the error is below rtol of the solution, or allowed, without what allow_share() adds.
  bool accurate(double rho, double rtol) const {
    return bounds_[0].error(rho) <= wanted(bounds_[0], rtol) && rho <= floor_;
  }
  /// Most that rho may be at the end, whatever the bound says.
  void set_floor(double rho) { floor_ = rho; }

  /// z = P^-1 r, of an r that set_residual(first node, last node) makes of all nodes, range by range; returns
  /// r . z.
  template <class Set>
  double precondition(Set&& set_residual) {
    team_.run([&](int thread) {
      team_.over_clusters(thread, [&](std::size_t cluster, int first, int last) {
        set_residual(first, last);
        precondition(cluster, first, last);
      });
      team_.barrier();
      coarse(thread);
    });
    return squared_residual();
  }
  /// Nothing was found and no direction has been taken yet.
  void restart();
  /// Iterates from z = P^-1 r until rho falls to `spent` or the error is below rtol of the solution.
  /// @param rho   in: of precondition(); out: at the end.  @param beta  share of the last direction in the
  ///   first one
  /// @param unit  the matrix's energy of a unit of rho.  @param left  most iterations
  dynamics::SolveStatus reduce(double& rho, double beta, double spent, double unit, double rtol, int left,
                               int& steps);
  /// What rounding left in a new residual is not orthogonal to the last direction, on which the length of the
  /// next step relies: the least error along it makes it so.
  bool minimise_along_last();
  /// The whole of P^-1 r into z, and the share of the last direction that makes the next one orthogonal to
  /// it: beta = -(z . A p)/(p . A p).
  double orthogonal_to_last();

 private:
  bool reached(const EnergyBound& bound, double rho, double rtol) const {
    return bound.error(rho) <= std::max(wanted(bound, rtol), share_ * share_ * bound.gained()) &&
           rho <= floor_;
  }
  double wanted(const EnergyBound& bound, double rtol) const {
    return std::max(rtol * rtol * bound.solution(), allowed_);
  }
  bool coarse_on() const { return clusters_.ready(); }
  void precondition(std::size_t cluster, int first, int last);
  double gather(std::size_t cluster);
  void coarse(int thread);
  double squared_residual() const;
  template <class Follow>
  void over_motions(std::size_t cluster, int first, int last, Follow&& follow) const;

  const NodeKernels& kernels_;
  ClusterTeam& team_;
  const SingleMatrix& matrix_;
  const RigidModeCoarseSpace& clusters_;
  Singles d_, r_, z_, p_, q_;
  Singles y_, w_;   ///< of the clusters: force and moment, and their motion
  Singles pieces_;  ///< motion of their pieces
  double pq_ = 0.0, floor_ = 0.0, allowed_ = 0.0, share_ = 0.0;
  bool moved_ = false;        ///< d_ + last_length_ p_ is what was found
  float last_length_ = 0.0f;  ///< of the last step, which d_ lacks
  /// one a thread, all alike: each decides for itself, with nothing to wait for
  std::vector<EnergyBound> bounds_;
  std::vector<double> partial_, partial_pq_;  ///< of clusters, of parts
};

}  // namespace palpate::linear
