#pragma once
#include <Eigen/Core>

#include <vector>

#include "linear/mixed_precision/single_matrix.h"
#include "palpate/dynamics/matrix.h"

namespace palpate::linear {

/// Coarse space of a two-level preconditioner (Mandel 1993; for elasticity, rigid modes as in smoothed
/// aggregation, Vanek, Mandel, Brezina 1996): each cluster of nodes moves as a rigid body, six directions per
/// cluster,
///     Z = block diagonal of Z_I,   (Z_I (w, turn))_i = w + turn x arm_i,   arm_i = x_i - centre of cluster,
///     P^-1 = J^-1 + Z E^-1 Z^T,    E = Z^T A Z.
/// Block Jacobi alone damps error components that vary from node to node and leaves those that span many
/// nodes to the iteration. Rigid motions of clusters cause no strain inside them, so Z spans nearly all of
/// these components: the number of iterations depends on the nodes per cluster, not on those of the body.
///
/// A dense E^-1 limits the number of clusters, so clusters of large bodies have many nodes. Components that
/// vary within a cluster are left to its pieces of some thirty nodes each: rigid motions Y of the pieces,
/// each solved independently like the blocks of J (additive levels, Bramble, Pasciak and Xu 1990; here with
/// rigid motions):
///     P^-1 = J^-1 + Y D^-1 Y^T + Z E^-1 Z^T,    D = block diagonal of Y^T A Y, 6x6 blocks.
/// A cluster moves its pieces with it: Z = Y B. Forces are therefore summed over nodes, and nodes moved, once
/// for both levels, by way of the pieces. P is positive definite for any Y, Z and any positive definite D, E:
/// all may be computed from an earlier matrix, and single precision suffices.
///
/// Without positions (arm = 0) clusters and pieces only translate.
class RigidModeCoarseSpace {
 public:
  /// Force and moment, or translation and rotation, of a piece or cluster.
  using Six = Eigen::Matrix<float, 6, 1>;
  /// Sets the clusters and pieces; E and D become invalid.
  void prepare(const NodeOrder& order);
  /// Computes E and D of this matrix. Returns false if E is not positive definite.
  /// @param positions  Node positions [m], 3 per node, original numbering; null: none, so that arms are zero.
  bool refresh(const SingleMatrix& A, const double* positions, const NodeKernels& kernels);
  bool ready() const { return ready_; }
  /// Rescales E and D for copies of this scale (SingleMatrix::scale): E^-1 of scale A is E^-1 / scale.
  void serve(double scale);
  void forget() { ready_ = false; }

  int stride() const { return stride_; }
  int size() const { return size_; }
  const float* inverse() const { return E_.data(); }
  const float* arm() const { return arm_.data(); }  ///< arm about the centre of each node's piece
  /// Computes Y^T r and Z^T r of one cluster, six numbers each, and replaces Y^T r by D^-1 Y^T r.
  /// Returns the cluster's share of r . Y D^-1 Y^T r.
  /// @param of_pieces  Out: six numbers per piece, indexed by piece over all clusters.
  /// @param of_cluster  Out: six numbers of this cluster.
  double gather(std::size_t cluster, const NodeOrder& order, const NodeKernels& kernels, const float* r,
                float* of_pieces, float* of_cluster) const;
  /// Returns the motion of a piece: its cluster's motion plus `own`, the motion of the piece itself.
  Six motion(std::size_t piece, const float* own, const float* of_cluster) const;

 private:
  struct Piece {
    /// Offset of the piece's centre from the cluster's centre [cluster radii].
    Eigen::Vector3f offset = Eigen::Vector3f::Zero();
    float radius = 1.0f;  ///< radius of the piece [cluster radii]
    Eigen::Matrix<float, 6, 6> inverse = Eigen::Matrix<float, 6, 6>::Zero();  ///< D^-1
  };
  void place_arms(const NodeOrder& order, const double* positions);
  void skip_held(const SingleMatrix& A);
  void assemble(const SingleMatrix& A);
  void add_points(const PointOperator& points);
  void invert_pieces();
  Eigen::Vector3f arm_in_cluster(std::size_t node) const;

  bool ready_ = false, finer_ = false;  ///< finer_: there are more pieces than clusters
  int size_ = 0, stride_ = 0;
  double scale_ = 1.0;                ///< scale of the copy that E and D belong to
  std::vector<int> cluster_, piece_;  ///< cluster and piece of each node, in NodeOrder's numbering
  std::vector<Piece> pieces_;
  std::vector<float> arm_, E_;
};

}  // namespace palpate::linear
