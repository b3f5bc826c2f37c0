#pragma once
#include <vector>

#include "integrate/linear/single_matrix.h"
#include "palpate/dynamics/matrix.h"

namespace palpate::integrate {

/// The coarse space of a two-level preconditioner (Mandel 1993; for elasticity, rigid modes as in smoothed aggregation, Vanek, Mandel, Brezina 1996):
/// each cluster of nodes moves as a rigid body, six directions a cluster,
///     Z = block diagonal of Z_I,   (Z_I (w, turn))_i = w + turn x arm_i,   arm_i = x_i - centre of the cluster,
///     P^-1 = J^-1 + Z E^-1 Z^T,    E = Z^T A Z.
/// Block Jacobi alone damps what varies from node to node and leaves what spans many nodes to the iteration; rigid motions of clusters cost no
/// strain inside them, so Z spans nearly all of that: the count of iterations depends on the nodes of a cluster, not of the body.
/// Any Z and any positive definite E make P positive definite: both may be those of an earlier matrix, and single precision is enough.
/// Without positions (arm = 0) the clusters only translate.
class RigidClusters {
 public:
  /// New clusters; forgets E.
  void prepare(const NodeOrder& order);
  /// E of this matrix with arms at these positions (original numbering; null: none).  False: E is not positive definite.
  bool refresh(const SingleMatrix& A, const double* positions, const NodeKernels& kernels);
  bool ready() const { return ready_; }
  void forget() { ready_ = false; }

  int stride() const { return stride_; }
  int size() const { return size_; }
  const float* inverse() const { return E_.data(); }
  const float* arm() const { return arm_.data(); }

 private:
  void place_arms(const NodeOrder& order, const double* positions);
  void leave_out_held(const SingleMatrix& A);
  void assemble(const SingleMatrix& A);

  bool ready_ = false;
  int size_ = 0, stride_ = 0;
  std::vector<int> cluster_;      ///< of each node, in the order's numbering
  std::vector<float> arm_, E_;
};

}  // namespace palpate::integrate
