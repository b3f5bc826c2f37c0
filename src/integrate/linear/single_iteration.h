#pragma once
#include "integrate/linear/energy_bound.h"
#include "integrate/linear/rigid_clusters.h"
#include "integrate/linear/single_matrix.h"

namespace palpate::integrate {

/// The iteration of conjugate gradients in single precision: (A scale) d = r, from a residual r of order one, in the units of the copy.  The preconditioner is the
/// inverse diagonal blocks, and rigid clusters where there are some.  Who drives it says how large r really is, and when the error is small enough.
class SingleIteration {
 public:
  SingleIteration(const NodeKernels& kernels, ClusterTeam& team, const SingleMatrix& matrix, const RigidClusters& clusters)
      : kernels_(kernels), team_(team), matrix_(matrix), clusters_(clusters) {}

  void prepare();
  Singles& residual() { return r_; }
  const Singles& correction() const { return d_; }
  void clear_correction();

  /// The bound of a new solve.  @param start  as EnergyBound::begin
  void begin(double start);
  void end();
  bool first() const { return bounds_[0].first(); }
  /// Whether the error is below rtol of the solution's lower bound, for rho = r . P^-1 r in units of the matrix.
  bool reached(double rho, double rtol) const { return reached(bounds_[0], rho, rtol); }
  /// Upper bound of the error of the solution, squared, and lower bound of the solution's own square, for such a rho.
  double error(double rho) const { return bounds_[0].error(rho); }
  double solution() const { return bounds_[0].solution(); }
  /// Most that rho may be at the end, whatever the bound says.
  void set_floor(double rho) { floor_ = rho; }

  /// z = P^-1 r; returns r . z.
  double precondition();
  /// No direction has been taken yet.
  void forget_direction();
  /// Iterates from z = P^-1 r until rho falls to `spent` or the error is below rtol of the solution.
  /// @param rho   in: of precondition(); out: at the end.  @param beta  share of the last direction in the first one
  /// @param unit  the matrix's energy of a unit of rho.  @param left  most iterations
  dynamics::SolveStatus reduce(double& rho, double beta, double spent, double unit, double rtol, int left, int& steps);
  /// What rounding left in a new residual is not orthogonal to the last direction, on which the length of the next step relies: the least error along it makes it so.
  bool minimise_along_last();
  /// The whole of P^-1 r into z, and the share of the last direction that makes the next one orthogonal to it: beta = -(z . A p)/(p . A p).
  double orthogonal_to_last();

 private:
  bool reached(const EnergyBound& bound, double rho, double rtol) const { return bound.error(rho) <= rtol * rtol * bound.solution() && rho <= floor_; }
  bool coarse_on() const { return clusters_.ready(); }
  double gather(std::size_t cluster);
  void coarse(int thread);
  double coarse_share() const;
  void direction(std::size_t cluster, float a, float b, float* d, float* p, int first, int last) const;

  const NodeKernels& kernels_;
  ClusterTeam& team_;
  const SingleMatrix& matrix_;
  const RigidClusters& clusters_;
  Singles d_, r_, z_, p_, q_;
  Singles y_, w_;    ///< of the clusters: force and moment, and their motion
  Singles pieces_;   ///< motion of their pieces
  double pq_ = 0.0, floor_ = 0.0;
  std::vector<EnergyBound> bounds_;  ///< one a thread, all alike: each decides for itself, with nothing to wait for
  std::vector<double> partial_, partial_pq_;  ///< of clusters, of parts
};

}  // namespace palpate::integrate
