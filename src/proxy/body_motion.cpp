#include "proxy/body_motion.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace palpate::proxy {

void BodyMotion::resize(int nodes) {
  count_ = nodes;
  now_.resize(padded(nodes));
  then_.resize(padded(nodes));
  samples_.clear();
  const int samples = std::min(nodes, kSamples);
  for (int i = 0; i < samples; ++i)
    samples_.push_back(static_cast<int>(static_cast<long>(i) * nodes / samples));
  coefficients_.setZero(3, samples);
}

void BodyMotion::fit(const Eigen::Ref<const Points>& nodes) {
  const Vec3 origin = nodes.col(samples_.front());
  Vec3 sum = Vec3::Zero();
  linear_.setZero();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Vec3 x = nodes.col(samples_[i]) - origin;
    sum += x;
    linear_.noalias() += x * coefficients_.col(static_cast<Eigen::Index>(i)).transpose();
  }
  offset_ = origin + sum / static_cast<double>(samples_.size()) - linear_ * middle_;
}

void BodyMotion::update(const Eigen::Ref<const Points>& nodes) {
  fit(nodes);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = linear_;
  residual_ = std::sqrt(take(nodes.data(), static_cast<int>(nodes.outerStride()), count_, then_.read(0),
                             rows.data(), offset_.data(), now_.write(0)));
}

void BodyMotion::keep() {
  constexpr double kFlat = 1e-8;
  then_ = now_;  // equal sizes: copies without allocating
  middle_.setZero();
  for (const int n : samples_) middle_ += then_.point(n) / static_cast<double>(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i)
    coefficients_.col(static_cast<Eigen::Index>(i)) = then_.point(samples_[i]) - middle_;
  Mat3 M = coefficients_ * coefficients_.transpose();
  M += kFlat * M.trace() * Mat3::Identity();  // regularised, so that a flat body or one of few nodes has a
                                              // map too
  coefficients_ = (M.trace() > 0.0 ? Mat3(M.inverse()) : Mat3(Mat3::Zero())) * coefficients_;
  linear_.setIdentity();
  offset_.setZero();
  residual_ = 0.0;
}

}  // namespace palpate::proxy
