// Bound on the skin.  A vertex of the skin at rest,
//
//   X = sum w_k X_k    (weights of its tetrahedron, sum 1),    is now at    x = sum w_k x_k.
//
// Let the proxy move by g(X) = F X + t, with any F and t; node k differs from that motion by
//
//   d_k = x_k - g(X_k).
//
// Because g is affine and the weights sum to one,
//
//   x - g(X) = sum w_k (x_k - g(X_k)) = sum w_k d_k,      |x - g(X)| <= s D,
//   s = max over the skin of sum |w_k| (1 inside),        D = max over the nodes of |d_k|.
//
// The hull H has few corners, so at rest the vertex may lie outside H by up to e: X = y + z with y in H and
// z| <= e.  Then g(y) lies in the moved hull F H + t (the image of a hull under an affine map is the hull of
// the images, also for a mirrored or flat one), and
//
//   distance of x from F H + t  <=  |x - g(X)| + |g(X) - g(y)|  <=  s D + |F|_2 e  =  the inflation.
//
// A node of a tetrahedron that the proxy owns is within |d_k| + |F|_2 e of the moved hull, which is no more.
// The bound assumes nothing about F and t: any motion of the nodes (squashed, inverted, scattered) makes the
// inflation larger, never wrong.  The best F and t make D small: the least-squares fit,
//
//   t = mean x - F mean X,   F = [sum x_k (X_k - mean X)^T] M^-1,   M = sum (X_k - mean X)(X_k - mean X)^T,
//
// has D = 0 under stretch, shear and flattening, so that only curvature within a proxy counts; for the mean
// rotation, F = polar factor of the sum in brackets, strain times the proxy's size counts.  With
//
//   q_k = M^-1 (X_k - mean X),   sum q_k = 0,   F = sum x_k q_k^T    from any origin:
//
// one pass over the nodes.
//
// Lazy fitting.  A fit costs a pass over the nodes of the proxy, and most proxies are far from every other
// surface; bounding boxes prove that.  At a fit of all proxies the box of each proxy (all its points y,
// centre c, half edges e) is stored, with the positions p_k of all nodes.  Later
//
//   x_k = G p_k + h + d_k,      G and h: one affine map for the whole body (body_motion.h),
//
// and by the first bound each point of the proxy is within s max |d_k| of G y + h: it lies in the box with
// centre G c + h and half edges |G| e, grown by that.  The maximum takes one pass over the nodes.  Nothing
// else depends on the stored boxes: a proxy whose box may meet something is fitted to the present nodes. When
// the boxes have grown by a fifth, all proxies are fitted and stored again.
#include "proxy/proxy_set.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "core/polar.h"
#include "palpate/core/error.h"
#include "proxy/proxy_set_impl.h"

namespace palpate::proxy {
namespace {

/// Returns the spectral norm, from the largest root of the characteristic polynomial of C = F^T F by the
/// trigonometric formula (Smith 1961): with m = tr C / 3, p^2 = |C - m I|_F^2 / 6 and r = det((C - m I) / p)
/// / 2 it is m + 2 p cos(acos(r) / 3).
double spectral_norm(const Mat3& F) {
  const Mat3 C = F.transpose() * F;
  const double m = C.trace() / 3.0;
  const Mat3 B = C - m * Mat3::Identity();
  const double p = std::sqrt(B.squaredNorm() / 6.0);
  if (!(p > 1e-14 * m)) return std::sqrt(m) * (1.0 + 1e-12);
  const double r = std::clamp((B / p).determinant() / 2.0, -1.0, 1.0);
  return std::sqrt(m + 2.0 * p * std::cos(std::acos(r) / 3.0)) * (1.0 + 1e-12);
}

}  // namespace

ProxySet::~ProxySet() = default;
ProxySet::ProxySet(ProxySet&&) noexcept = default;

Vec3 ProxySet::Impl::first_node(const Cloud& cloud) const {
  const Columns now = motion.nodes();
  const int n = node[static_cast<std::size_t>(cloud.first)];
  return {now.x[n], now.y[n], now.z[n]};
}

void ProxySet::Impl::gather(const Cloud& cloud, const Vec3& origin) {
  proxy::gather(motion.nodes(), node.data() + cloud.first, cloud.lanes, origin.data(), gathered.write(0));
}

/// Computes the least-squares map or the mean rotation from the cloud's nodes, gathered relative to its first
/// node so that the padding entries are zero.
void ProxySet::Impl::fit(const Cloud& cloud, ProxyState& state) {
  const Vec3 origin = first_node(cloud);
  gather(cloud, origin);
  double sums[12];
  moments(gathered.read(0), coefficients.read(cloud.first), cloud.lanes, sums);
  const Mat3 F = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(sums + 3);
  state.linear = options.follow == Follow::kAffine
                     ? F
                     : polar_decomposition(F * (cloud.spread / cloud.spread.trace())).R;
  state.offset = origin + Eigen::Map<const Vec3>(sums) / cloud.count - state.linear * cloud.middle;
}

/// Moves corners and box by the state's linear and offset, and sets the inflation.
void ProxySet::Impl::place(int proxy, double residual, double reach) {
  const auto at = static_cast<std::size_t>(proxy);
  ProxyState& state = states[at];
  constexpr double kRounding = 1e-13;
  state.stretch = options.follow == Follow::kAffine && soft ? spectral_norm(state.linear) : 1.0 + 1e-12;
  state.residual = weight_sum[at] * residual + kRounding * reach;
  state.inflation = state.stretch * outside[at] + state.residual;
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = state.linear;
  move(rest_corners.read(first_corner[at]), padded(corner_count[at]), rows.data(), state.offset.data(),
       corners.write(first_corner[at]), state.low.data(), state.high.data());
  state.low.array() -= state.inflation;
  state.high.array() += state.inflation;
  centre[at] = state.linear * rest_centre[at] + state.offset;
}

void ProxySet::Impl::refit(int p) {
  const auto at = static_cast<std::size_t>(p);
  const Cloud& cloud = own[at];
  ProxyState& state = states[at];
  fit(guide[at], state);
  const Vec3 origin = first_node(cloud);
  if (guide[at].first != cloud.first) gather(cloud, origin);
  const Vec3 relative = state.offset + state.linear * cloud.middle - origin;
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = state.linear;
  const double most = residuals(gathered.read(0), rest_nodes.read(cloud.first), cloud.lanes, rows.data(),
                                relative.data(), squares.data() + cloud.first);
  place(p, std::sqrt(most), origin.cwiseAbs().maxCoeff());
  fitted_at[at] = moment;
}

/// Computes loose boxes from the stored ones; returns the sum of their half edges.
double ProxySet::Impl::loosen() {
  constexpr double kRounding = 1e-13;
  const Mat3 G = motion.linear(), magnitude = G.cwiseAbs();
  double size = 0.0;
  for (std::size_t p = 0; p < boxes.size(); ++p) {
    const Vec3 middle = G * (0.5 * (kept_boxes[p].low + kept_boxes[p].high)) + motion.offset();
    Vec3 half = magnitude * (0.5 * (kept_boxes[p].high - kept_boxes[p].low));
    half.array() += weight_sum[p] * motion.residual() + kRounding * middle.cwiseAbs().maxCoeff();
    boxes[p] = {middle - half, middle + half};
    size += half.sum();
  }
  return size;
}

void ProxySet::update(const Eigen::Ref<const Points>& nodes) {
  constexpr double kLoose = 1.2;
  Impl& s = *impl_;
  PALPATE_CHECK(s.soft && nodes.cols() == s.node_count,
                "{} node positions given for the proxies of a body with {} nodes", nodes.cols(),
                s.node_count);
  ++s.moment;
  s.rest();
  s.motion.update(nodes);
  PALPATE_CHECK(std::isfinite(s.motion.residual()), "proxies: the position of a node is not finite");
  if (!(s.loosen() <= kLoose * s.kept_size)) {
    s.motion.keep();
    s.kept_size = 0.0;
    for (int p = 0; p < s.count; ++p) {
      const ProxyState& state = s.ready(p);
      PALPATE_CHECK(std::isfinite(state.inflation) && state.low.allFinite() && state.high.allFinite(),
                    "proxy {}: the position of a node is not finite", p);
      s.kept_boxes[static_cast<std::size_t>(p)] = {state.low, state.high};
      s.kept_size += 0.5 * (state.high - state.low).sum();
    }
    s.boxes = s.kept_boxes;
  }
  proxy::refit(s.tree, s.boxes);
}

void ProxySet::update(const Pose& pose) {
  Impl& s = *impl_;
  PALPATE_CHECK(!s.soft, "proxies of a soft body must be updated by node positions, not by a pose");
  ++s.moment;
  s.rest();
  for (int p = 0; p < s.count; ++p) {
    const auto at = static_cast<std::size_t>(p);
    s.states[at].linear = pose.rotation.toRotationMatrix();
    s.states[at].offset = pose.translation;
    s.place(p, 0.0, pose.translation.cwiseAbs().maxCoeff());
    s.fitted_at[at] = s.moment;
    s.boxes[at] = {s.states[at].low, s.states[at].high};
  }
  proxy::refit(s.tree, s.boxes);
}

int ProxySet::size() const { return impl_->count; }
int ProxySet::face_count() const { return static_cast<int>(impl_->skin.faces.size()); }
const ProxyState& ProxySet::state(int proxy) const { return impl_->ready(proxy); }
int ProxySet::bone(int proxy) const { return impl_->bone[static_cast<std::size_t>(proxy)]; }
int ProxySet::corner_count(int proxy) const { return impl_->corner_count[static_cast<std::size_t>(proxy)]; }
const Vec3& ProxySet::centre(int proxy) const {
  impl_->ready(proxy);
  return impl_->centre[static_cast<std::size_t>(proxy)];
}
std::span<const ProxyBranch> ProxySet::tree() const { return impl_->tree; }

bool ProxySet::neighbours(int p, int q) const {
  return impl_->adjacent[static_cast<std::size_t>(p * impl_->count + q)] != 0;
}

void ProxySet::copy_corners(int proxy, Eigen::Ref<Points> out) const {
  impl_->ready(proxy);
  const Columns from = impl_->corners.read(impl_->first_corner[static_cast<std::size_t>(proxy)]);
  for (int i = 0; i < corner_count(proxy); ++i) out.col(i) = Vec3(from.x[i], from.y[i], from.z[i]);
}

Vec3 ProxySet::support(int proxy, const Vec3& direction) const {
  impl_->ready(proxy);
  const Columns from = impl_->corners.read(impl_->first_corner[static_cast<std::size_t>(proxy)]);
  const int i = farthest(from, padded(corner_count(proxy)), direction.data());
  return {from.x[i], from.y[i], from.z[i]};
}

double ProxySet::most_along(int proxy, const Vec3& direction) const {
  impl_->ready(proxy);
  return proxy::most_along(impl_->corners.read(impl_->first_corner[static_cast<std::size_t>(proxy)]),
                           padded(corner_count(proxy)), direction.data());
}

}  // namespace palpate::proxy
