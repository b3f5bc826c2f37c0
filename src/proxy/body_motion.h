#pragma once
#include <vector>

#include "proxy/table.h"

namespace palpate::proxy {

/// How a body's nodes have moved since they were last stored:
/// x = linear x_then + offset to within `residual`, for every node.
///
/// Any affine map serves (the residual is measured against it, node by node); it is the one of least squares
/// for a few nodes spread over the body, so that a body that moves as a whole, and stretches evenly, leaves
/// no residual at all.
class BodyMotion {
 public:
  void resize(int nodes);
  /// Takes the present positions.  @throws nothing; `residual` is not a number where a position is not
  void update(const Eigen::Ref<const Points>& nodes);
  void keep();  ///< the present positions are the ones to count from

  Columns nodes() const { return now_.read(0); }
  const Mat3& linear() const { return linear_; }
  const Vec3& offset() const { return offset_; }
  double residual() const { return residual_; }

 private:
  void fit(const Eigen::Ref<const Points>& nodes);

  static constexpr int kSamples = 64;
  int count_ = 0;
  Table now_, then_;
  std::vector<int> samples_;
  Vec3 middle_ = Vec3::Zero();  // of the samples, then
  Points coefficients_;         // q = M^-1 (x_then - middle): see proxy_set.cpp
  Mat3 linear_ = Mat3::Identity();
  Vec3 offset_ = Vec3::Zero();
  double residual_ = 0.0;
};

}  // namespace palpate::proxy
