// Application of the bound of proxy_set.cpp to a patch of skin, at rest in a ball of centre c and radius r:
// its faces are within |F|_2 r + s D of F c + t.  D is taken over the whole proxy, or over the nodes of the
// patch's vertices, which is less where the proxy is dented elsewhere.
#include <algorithm>
#include <cmath>
#include <utility>

#include "proxy/proxy_set_impl.h"

namespace palpate::proxy {

void ProxySet::Impl::ready_balls(int proxy) {
  const auto at = static_cast<std::size_t>(proxy);
  const ProxyState& state = ready(proxy);
  if (std::exchange(balls_at[at], moment) == moment) return;
  const int first = first_ball[at],
            lanes = (at + 1 < first_ball.size() ? first_ball[at + 1] : rest_balls.size()) - first;
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = state.linear;
  double low[3], high[3];
  move(rest_balls.read(first), lanes, rows.data(), state.offset.data(), balls.write(first), low, high);
  for (int i = first; i < first + lanes; ++i)
    radius[static_cast<std::size_t>(i)] =
        state.stretch * rest_radius[static_cast<std::size_t>(i)] + state.residual;
}

/// Replaces the proxy's residual by the maximum over the patch's nodes, unless the residual is small.
void ProxySet::Impl::measure(int number) {
  constexpr double kSmall = 0.1;
  const SkinPatch& patch = skin.patches[static_cast<std::size_t>(number)];
  ready_balls(patch.proxy);
  if (std::exchange(measured_at[static_cast<std::size_t>(number)], moment) == moment) return;
  const ProxyState& state = states[static_cast<std::size_t>(patch.proxy)];
  if (!soft || state.residual < kSmall * state.stretch * patch.radius) return;
  double most = 0.0;
  for (int i = patch.first_slot; i < patch.first_slot + patch.slot_count; ++i)
    most = std::max(most, squares[static_cast<std::size_t>(patch_slots[static_cast<std::size_t>(i)])]);
  const int ball = ball_of_patch[static_cast<std::size_t>(number)];
  radius[static_cast<std::size_t>(ball)] = state.stretch * patch.radius + patch.weight_sum * std::sqrt(most) +
                                           1e-13 * balls.point(ball).cwiseAbs().maxCoeff();
}

// A moving patch sweeps the balls from c to c + drift, which lie in the ball around the middle of that
// segment.
void ProxySet::patches_near(int proxy, const ProxySet& other, int hull, const Reach& reach,
                            const Vec3& toward, std::span<const unsigned char> known,
                            std::vector<int>& out) const {
  constexpr int kQuickSteps = 2, kSteps = 4;
  Impl& s = *impl_;
  s.ready_balls(proxy);
  const ProxyState& state = s.states[static_cast<std::size_t>(proxy)];
  const ProxyState& grown = other.state(hull);
  const double gap = reach.without_drift(), margin = grown.inflation + gap;
  const Vec3 half_way = 0.5 * reach.drift;
  const double half_length = half_way.norm();
  const int first = s.first_ball[static_cast<std::size_t>(proxy)],
            first_patch = s.skin.first_of_proxy[static_cast<std::size_t>(proxy)];
  const int count = s.skin.first_of_proxy[static_cast<std::size_t>(proxy) + 1] - first_patch;
  for (int i = 0; i < padded(count); ++i)
    s.near[static_cast<std::size_t>(i)] = i < count && !known[static_cast<std::size_t>(first_patch + i)];
  const Vec3 between = (centre(proxy) - other.centre(hull)).normalized();
  for (const Vec3& direction : {toward, between})
    if (!direction.isZero() && direction.allFinite())
      balls_beyond(direction.data(),
                   other.most_along(hull, direction) + grown.inflation + reach.along(direction),
                   s.balls.read(first), s.radius.data() + first, padded(count), s.near.data());

  const Vec3 low = grown.low.array() - gap, high = grown.high.array() + gap;
  const HullColumns columns{
      other.impl_->corners.read(other.impl_->first_corner[static_cast<std::size_t>(hull)]),
      padded(other.corner_count(hull)),
      low.data(),
      high.data(),
      other.centre(hull).data(),
      margin};
  int left = 0;
  for (int i = 0; i < count; ++i)
    if (s.near[static_cast<std::size_t>(i)]) s.near_patch[static_cast<std::size_t>(left++)] = first_patch + i;
  const bool twice = s.soft && state.residual > 0.0;
  for (int round = 0; round < 1 + twice && left > 0; ++round) {  // by the proxy's bound, then by the patches'
                                                                 // bounds
    for (int i = 0; i < padded(left); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const int patch = s.near_patch[i < left ? at : 0];
      if (round == static_cast<int>(twice)) s.measure(patch);
      const int ball = s.ball_of_patch[static_cast<std::size_t>(patch)];
      const Vec3 c = s.balls.point(ball) + half_way;
      s.near_balls.x[at] = c.x(), s.near_balls.y[at] = c.y(), s.near_balls.z[at] = c.z();
      s.near_radius[at] = s.radius[static_cast<std::size_t>(ball)] + half_length;
    }
    balls_near(columns, s.near_balls.read(0), s.near_radius.data(), padded(left),
               round == static_cast<int>(twice) ? kSteps : kQuickSteps, s.near.data());
    int kept = 0;
    for (int i = 0; i < left; ++i)
      if (s.near[static_cast<std::size_t>(i)])
        s.near_patch[static_cast<std::size_t>(kept++)] = s.near_patch[static_cast<std::size_t>(i)];
    left = kept;
  }
  out.assign(s.near_patch.begin(), s.near_patch.begin() + left);
}

std::span<const SkinPatch> ProxySet::patches() const { return impl_->skin.patches; }

std::span<const SkinPatch> ProxySet::patches(int proxy) const {
  const int first = impl_->skin.first_of_proxy[static_cast<std::size_t>(proxy)],
            end = impl_->skin.first_of_proxy[static_cast<std::size_t>(proxy) + 1];
  return {impl_->skin.patches.data() + first, static_cast<std::size_t>(end - first)};
}

Ball ProxySet::ball(const SkinPatch& patch) const {
  const int number = static_cast<int>(&patch - impl_->skin.patches.data());
  impl_->measure(number);
  const int ball = impl_->ball_of_patch[static_cast<std::size_t>(number)];
  return {impl_->balls.point(ball), impl_->radius[static_cast<std::size_t>(ball)]};
}

// Area vectors transform with the cofactors: n da = cof(F) N dA (Nanson).
Vec3 ProxySet::area(const SkinPatch& patch) const {
  const Mat3& F = state(patch.proxy).linear;
  return patch.area.x() * F.col(1).cross(F.col(2)) + patch.area.y() * F.col(2).cross(F.col(0)) +
         patch.area.z() * F.col(0).cross(F.col(1));
}

std::span<const int> ProxySet::faces(const SkinPatch& patch) const {
  return {impl_->skin.faces.data() + patch.first_face, static_cast<std::size_t>(patch.face_count)};
}

}  // namespace palpate::proxy
