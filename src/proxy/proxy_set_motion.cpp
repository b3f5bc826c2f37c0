// Velocity bounds of a proxy's skin and tetrahedra.
//
// Soft body.  A point of its skin is x = sum w_k x_k with constant weights of sum 1, so it moves with
//
//   v = sum w_k v_k,      v - V = sum w_k (v_k - V),      |v - V| <= s max |v_k - V|
//
// for any V, with s = max sum |w_k| as in proxy_set.cpp; V is the mean over the proxy's nodes.  A point of
// its tetrahedra is such a mean with weights in [0, 1].  Displacements x_k(1) - x_k(0) in place of
// velocities, of any length, give a bound on the displacements: the sum is the same.
//
// All proxies.  With V the mean over all nodes and R = max |v_k - V|, a proxy's mean is within R of V and its
// nodes within 2 R of that mean, so its bound lies within (1 + 2 s) R of V.
//
// Rigid body.  v = L X + l for a point X at rest: L = [omega] R under a twist, R(1) - R(0) for a
// displacement. With c the middle of the corners and everything within r of it, |v - (L c + l)| <= |L|_2 r;
// [omega] R|_2 = |omega|, and |R(1) - R(0)|_2 = 2 sin(theta / 2) for a relative rotation by theta.
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"
#include "proxy/least_width.h"
#include "proxy/proxy_set_impl.h"

namespace palpate::proxy {
namespace {

constexpr double kRounding = 1e-12;

Mat3 cross_matrix(const Vec3& w) {
  Mat3 out;
  out << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return out;
}

/// Returns the mean of some velocities, and the largest distance from it.
template <class At>
ProxyMotion around_mean(int count, const At& at) {
  ProxyMotion out;
  for (int i = 0; i < count; ++i) out.velocity += at(i);
  out.velocity /= count;
  double most = 0.0;
  for (int i = 0; i < count; ++i) most = std::max(most, (at(i) - out.velocity).squaredNorm());
  out.spread = std::sqrt(most);
  return out;
}

}  // namespace

void ProxySet::Impl::add_motions() {
  motions.resize(static_cast<std::size_t>(count));
  motion_at.assign(motions.size(), motions_set);
  if (soft) velocities = Points::Zero(3, node_count);
  for (int p = 0; p < count; ++p) {
    const auto at = static_cast<std::size_t>(p);
    double reach = 0.0;
    for (int c = 0; c < corner_count[at]; ++c)
      reach = std::max(reach, (rest_corners.point(first_corner[at] + c) - rest_centre[at]).norm());
    rest_reach.push_back(reach + outside[at]);
    Points corners_at_rest(3, corner_count[at]);
    for (int c = 0; c < corner_count[at]; ++c)
      corners_at_rest.col(c) = rest_corners.point(first_corner[at] + c);
    thickness.push_back(least_width(corners_at_rest));
  }
}

void ProxySet::Impl::rest() {
  if (motions.empty()) return;  // under construction
  ++motions_set;
  whole = widest = {};
  std::fill(motions.begin(), motions.end(), ProxyMotion{});
  std::fill(motion_at.begin(), motion_at.end(), motions_set);
}

void ProxySet::Impl::measure_motion(int proxy) {
  const auto p = static_cast<std::size_t>(proxy);
  motion_at[p] = motions_set;
  if (!soft) {
    const Vec3 middle = rate * rest_centre[p] + rate_offset;
    motions[p] = {middle, rate_norm * rest_reach[p] + kRounding * middle.norm()};
    return;
  }
  const int* nodes = node.data() + own[p].first;
  motions[p] = around_mean(own[p].count, [&](int i) { return velocities.col(nodes[i]); });
  motions[p].spread = weight_sum[p] * (motions[p].spread + kRounding * motions[p].velocity.norm());
}

void ProxySet::set_motion(const Eigen::Ref<const Points>& given) {
  Impl& s = *impl_;
  PALPATE_CHECK(s.soft && given.cols() == s.node_count,
                "{} node velocities given for the proxies of a body with {} nodes", given.cols(),
                s.node_count);
  ++s.motions_set;
  s.velocities = given;
  s.whole.velocity = given.rowwise().mean();
  const double weight_sum = *std::max_element(s.weight_sum.begin(), s.weight_sum.end());
  const double farthest = std::sqrt((given.colwise() - s.whole.velocity).colwise().squaredNorm().maxCoeff()) +
                          kRounding * s.whole.velocity.norm();
  s.whole.spread = weight_sum * farthest;
  s.widest = {s.whole.velocity, (1.0 + 2.0 * weight_sum) * farthest};
  PALPATE_CHECK(std::isfinite(s.whole.spread), "proxies: the velocity of a node is not finite");
}

void ProxySet::Impl::set_rigid_motion(const Mat3& linear, const Vec3& offset, double norm) {
  PALPATE_CHECK(!soft, "the motion of a soft body must be given by node velocities");
  PALPATE_CHECK(offset.allFinite() && std::isfinite(norm), "proxies: the velocity of a pose is not finite");
  ++motions_set;
  rate = linear;
  rate_offset = offset;
  rate_norm = norm;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& c : rest_centre) middle += c / count;
  double reach = 0.0;
  for (std::size_t p = 0; p < rest_centre.size(); ++p)
    reach = std::max(reach, (rest_centre[p] - middle).norm() + rest_reach[p]);
  const Vec3 velocity = rate * middle + rate_offset;
  whole = widest = {velocity, rate_norm * reach + 2.0 * kRounding * (velocity.norm() + rate_norm * reach)};
}

void ProxySet::set_motion(const Twist& twist) {
  impl_->set_rigid_motion(cross_matrix(twist.angular) * impl_->states.front().linear, twist.linear,
                          twist.angular.norm());
}

void ProxySet::set_motion_from(const Pose& before) {
  const ProxyState& now = impl_->states.front();
  const Mat3 then = before.rotation.toRotationMatrix();
  const double angle = rotation_vector(Quat(Mat3(now.linear * then.transpose()))).norm();
  impl_->set_rigid_motion(now.linear - then, now.offset - before.translation, 2.0 * std::sin(0.5 * angle));
}

const ProxyMotion& ProxySet::motion(int proxy) const {
  if (impl_->motion_at[static_cast<std::size_t>(proxy)] != impl_->motions_set) impl_->measure_motion(proxy);
  return impl_->motions[static_cast<std::size_t>(proxy)];
}
const ProxyMotion& ProxySet::motion() const { return impl_->whole; }
const ProxyMotion& ProxySet::widest_motion() const { return impl_->widest; }
double ProxySet::rest_thickness(int proxy) const { return impl_->thickness[static_cast<std::size_t>(proxy)]; }
double ProxySet::rest_thickness() const {
  return *std::min_element(impl_->thickness.begin(), impl_->thickness.end());
}

}  // namespace palpate::proxy
