#pragma once
#include <vector>

#include "proxy/table.h"

namespace palpate::proxy {

/// Affine motion of a body's nodes since they were last stored: x = linear x_then + offset to within
/// `residual`, for every node.
///
/// Any affine map is valid (the residual is measured against it, node by node).  This one is the
/// least-squares fit to a few nodes spread over the body, so that rigid motion and uniform stretch leave no
/// residual.
class BodyMotion {
 public:
  /// Allocates for a number of nodes and selects the samples.
  void resize(int nodes);
  /// Takes the present positions [m].  Never throws; `residual` is NaN if a position is not finite.
  void update(const Eigen::Ref<const Points>& nodes);
  void keep();  ///< stores the present positions as the reference

  Columns nodes() const { return now_.read(0); }
  const Mat3& linear() const { return linear_; }
  const Vec3& offset() const { return offset_; }
  double residual() const { return residual_; }

 private:
  /// Fits the affine map to the samples.
  void fit(const Eigen::Ref<const Points>& nodes);

  static constexpr int kSamples = 64;
  int count_ = 0;
  Table now_, then_;
  std::vector<int> samples_;
  Vec3 middle_ = Vec3::Zero();  // mean of the samples' stored positions
  Points coefficients_;         // q = M^-1 (x_then - middle): see proxy_set.cpp
  Mat3 linear_ = Mat3::Identity();
  Vec3 offset_ = Vec3::Zero();
  double residual_ = 0.0;
};

}  // namespace palpate::proxy
