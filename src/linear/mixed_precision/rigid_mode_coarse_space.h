#pragma once
#include <Eigen/Core>

#include <vector>

#include "linear/mixed_precision/single_matrix.h"
#include "palpate/dynamics/matrix.h"

namespace palpate::linear {

/// The coarse space of a two-level preconditioner (Mandel 1993; for elasticity, rigid modes as in smoothed
/// aggregation, Vanek, Mandel, Brezina 1996):
/// each cluster of nodes moves as a rigid body, six directions a cluster,
///     Z = block diagonal of Z_I,   (Z_I (w, turn))_i = w + turn x arm_i,   arm_i = x_i - centre of the
///     cluster,
///     P^-1 = J^-1 + Z E^-1 Z^T,    E = Z^T A Z.
/// Block Jacobi alone damps what varies from node to node and leaves what spans many nodes to the iteration;
/// rigid motions of clusters cost no strain inside them, so Z spans nearly all of that: the count of
/// iterations depends on the nodes of a cluster, not of the body.
/// A dense E^-1 allows so many clusters and no more, and those of large bodies have many nodes.  What varies
/// within them is for their pieces, some thirty nodes each: rigid motions Y of these, each solved by itself
/// as the blocks of J are (additive levels, Bramble, Pasciak and Xu 1990; here of rigid motions):
///     P^-1 = J^-1 + Y D^-1 Y^T + Z E^-1 Z^T,    D = block diagonal of Y^T A Y, six numbers a block.
/// A cluster moves its pieces with it: Z = Y B, so that forces are summed over nodes and nodes are moved once
/// for both, by way of the pieces. Any Y, Z and any positive definite D, E make P positive definite: all may
/// be those of an earlier matrix, and single precision is enough.
/// Without positions (arm = 0) clusters and pieces only translate.
class RigidModeCoarseSpace {
 public:
  using Six = Eigen::Matrix<float, 6, 1>;
  /// New clusters; forgets E and D.
  void prepare(const NodeOrder& order);
  /// E of this matrix with arms at these positions (original numbering; null: none).  False: E is not
  /// positive definite.
  bool refresh(const SingleMatrix& A, const double* positions, const NodeKernels& kernels);
  bool ready() const { return ready_; }
  /// E and D go on to serve copies of this scale (SingleMatrix::scale): E^-1 of scale A is E^-1 / scale.
  void serve(double scale);
  void forget() { ready_ = false; }

  int stride() const { return stride_; }
  int size() const { return size_; }
  const float* inverse() const { return E_.data(); }
  const float* arm() const { return arm_.data(); }  ///< about the centre of each node's piece
  /// Y^T r and Z^T r of one cluster, six numbers each: pieces one after the other; then D^-1 of the pieces in
  /// their place.  Returns r . Y D^-1 Y^T r of it.
  double gather(std::size_t cluster, const NodeOrder& order, const NodeKernels& kernels, const float* r,
                float* of_pieces, float* of_cluster) const;
  /// How a piece moves whose own motion and whose cluster's are these.
  Six motion(std::size_t piece, const float* own, const float* of_cluster) const;

 private:
  struct Piece {
    /// its centre from that of the cluster, in radii of the cluster
    Eigen::Vector3f offset = Eigen::Vector3f::Zero();
    float radius = 1.0f;                                                      ///< likewise
    Eigen::Matrix<float, 6, 6> inverse = Eigen::Matrix<float, 6, 6>::Zero();  ///< of D
  };
  void place_arms(const NodeOrder& order, const double* positions);
  void leave_out_held(const SingleMatrix& A);
  void assemble(const SingleMatrix& A);
  void add_points(const PointOperator& points);
  void invert_pieces();
  Eigen::Vector3f arm_in_cluster(std::size_t node) const;

  bool ready_ = false, finer_ = false;  ///< finer: there are more pieces than clusters
  int size_ = 0, stride_ = 0;
  double scale_ = 1.0;                ///< of the copy that E and D are in the units of
  std::vector<int> cluster_, piece_;  ///< of each node, in the order's numbering
  std::vector<Piece> pieces_;
  std::vector<float> arm_, E_;
};

}  // namespace palpate::linear
