// The bound.  A vertex of the skin at rest X = sum w_k X_k (weights of its tetrahedron, sum 1) is now at x = sum w_k x_k.  Let the proxy move by
// g(X) = F X + t, any F and t, and let node k differ from that by d_k = x_k - g(X_k).  Because g is affine and the weights sum to one,
//
//   x - g(X) = sum w_k (x_k - g(X_k)) = sum w_k d_k,      |x - g(X)| <= s D,   s = max over the skin of sum |w_k| (1 inside),   D = max over the nodes of |d_k|.
//
// The hull H has few corners, so at rest the vertex may lie outside of it by up to e: X = y + z, y in H, |z| <= e.  Then g(y) lies in the moved hull F H + t
// (the image of a hull under an affine map is the hull of the images, mirrored and flat ones too), and
//
//   distance of x from F H + t  <=  |x - g(X)| + |g(X) - g(y)|  <=  s D + |F|_2 e  =  the inflation.
//
// A node of a tetrahedron that the proxy owns is within |d_k| + |F|_2 e of it, which is no more.  Nothing was asked of F and t: what the nodes did (squashed,
// inverted, scattered) makes the inflation larger, never wrong.  The best F and t make D small: those of least squares,
//
//   t = mean x - F mean X,   F = [sum x_k (X_k - mean X)^T] M^-1,   M = sum (X_k - mean X)(X_k - mean X)^T,
//
// where stretch, shear and flattening cost nothing and only what is curved within a proxy counts; or the mean rotation, F = polar factor of the sum in brackets,
// where strain counts with the proxy's size.  With q_k = M^-1 (X_k - mean X), which sum to zero, F = sum x_k q_k^T from any origin: one pass over the nodes.
// The same with the nodes and weights of a few faces alone bounds a patch: its ball moves to F c + t and grows to |F|_2 r + s D of the patch.
#include "palpate/proxy/proxy_set.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"
#include "palpate/core/polar.h"
#include "proxy/proxy_set_impl.h"

namespace palpate::proxy {
namespace {

/// Spectral norm from the largest root of the characteristic polynomial of C = F^T F, with the trigonometric formula (Smith 1961): with m = tr C / 3,
/// p^2 = |C - m I|_F^2 / 6 and r = det((C - m I) / p) / 2 it is m + 2 p cos(acos(r) / 3).
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

void ProxySet::Impl::gather(const Eigen::Ref<const Points>& nodes, const Cloud& cloud, const Vec3& origin) {
  for (int i = 0; i < cloud.lanes; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double* p = nodes.data() + nodes.outerStride() * node[static_cast<std::size_t>(cloud.first) + at];
    gathered.x[at] = p[0] - origin[0];
    gathered.y[at] = p[1] - origin[1];
    gathered.z[at] = p[2] - origin[2];
  }
}

/// The map of least squares or the mean rotation, from the cloud's nodes as gathered about its first: the entries that fill up the lanes are zero then.
void ProxySet::Impl::fit(const Eigen::Ref<const Points>& nodes, const Cloud& cloud, ProxyState& state) {
  const Vec3 origin = nodes.col(node[static_cast<std::size_t>(cloud.first)]);
  gather(nodes, cloud, origin);
  double sums[12];
  moments(gathered.read(0), coefficients.read(cloud.first), cloud.lanes, sums);
  const Mat3 F = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(sums + 3);
  state.linear = options.follow == Follow::kAffine ? F : polar_decomposition(F * (cloud.spread / cloud.spread.trace())).R;
  state.offset = origin + Eigen::Map<const Vec3>(sums) / cloud.count - state.linear * cloud.middle;
}

/// Moves corners and box, once linear and offset are set.
void ProxySet::Impl::place(int proxy, double residual, double reach) {
  const auto at = static_cast<std::size_t>(proxy);
  ProxyState& state = states[at];
  constexpr double kRounding = 1e-13;
  state.stretch = options.follow == Follow::kAffine && soft ? spectral_norm(state.linear) : 1.0 + 1e-12;
  state.residual = weight_sum[at] * residual + kRounding * reach;
  state.inflation = state.stretch * outside[at] + state.residual;
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = state.linear;
  move(rest_corners.read(first_corner[at]), padded(corner_count[at]), rows.data(), state.offset.data(), corners.write(first_corner[at]), state.low.data(),
       state.high.data());
  state.low.array() -= state.inflation;
  state.high.array() += state.inflation;
  centre[at] = state.linear * rest_centre[at] + state.offset;
}

void ProxySet::update(const Eigen::Ref<const Points>& nodes) {
  Impl& s = *impl_;
  PALPATE_CHECK(s.soft && nodes.cols() == s.node_count, "{} node positions for proxies of a body of {}", nodes.cols(), s.node_count);
  for (int p = 0; p < s.count; ++p) {
    const auto at = static_cast<std::size_t>(p);
    const Cloud& cloud = s.own[at];
    ProxyState& state = s.states[at];
    s.fit(nodes, s.guide[at], state);
    const Vec3 origin = nodes.col(s.node[static_cast<std::size_t>(cloud.first)]);
    if (s.guide[at].first != cloud.first) s.gather(nodes, cloud, origin);
    const Vec3 relative = state.offset + state.linear * cloud.middle - origin;
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = state.linear;
    const double most = residuals(s.gathered.read(0), s.rest_nodes.read(cloud.first), cloud.lanes, rows.data(), relative.data(),
                                  s.squares.data() + cloud.first);
    s.place(p, std::sqrt(most), origin.cwiseAbs().maxCoeff());
    PALPATE_CHECK(std::isfinite(state.inflation) && state.low.allFinite() && state.high.allFinite(), "proxy {}: a position of its nodes is not finite", p);
  }
  refit(s.tree, s.states);
}

void ProxySet::update(const Pose& pose) {
  Impl& s = *impl_;
  PALPATE_CHECK(!s.soft, "a soft body's proxies follow its nodes, not a pose");
  for (int p = 0; p < s.count; ++p) {
    s.states[static_cast<std::size_t>(p)].linear = pose.rotation.toRotationMatrix();
    s.states[static_cast<std::size_t>(p)].offset = pose.translation;
    s.place(p, 0.0, pose.translation.cwiseAbs().maxCoeff());
  }
  refit(s.tree, s.states);
}

int ProxySet::size() const { return impl_->count; }
int ProxySet::face_count() const { return static_cast<int>(impl_->skin.faces.size()); }
const ProxyState& ProxySet::state(int proxy) const { return impl_->states[static_cast<std::size_t>(proxy)]; }
int ProxySet::bone(int proxy) const { return impl_->bone[static_cast<std::size_t>(proxy)]; }
int ProxySet::corner_count(int proxy) const { return impl_->corner_count[static_cast<std::size_t>(proxy)]; }
const Vec3& ProxySet::centre(int proxy) const { return impl_->centre[static_cast<std::size_t>(proxy)]; }
std::span<const ProxyBranch> ProxySet::tree() const { return impl_->tree; }
std::span<const SkinPatch> ProxySet::patches() const { return impl_->skin.patches; }

bool ProxySet::neighbours(int p, int q) const { return impl_->adjacent[static_cast<std::size_t>(p * impl_->count + q)] != 0; }

void ProxySet::copy_corners(int proxy, Eigen::Ref<Points> out) const {
  const Columns from = impl_->corners.read(impl_->first_corner[static_cast<std::size_t>(proxy)]);
  for (int i = 0; i < corner_count(proxy); ++i) out.col(i) = Vec3(from.x[i], from.y[i], from.z[i]);
}

Vec3 ProxySet::support(int proxy, const Vec3& direction) const {
  const Columns from = impl_->corners.read(impl_->first_corner[static_cast<std::size_t>(proxy)]);
  const int i = farthest(from, padded(corner_count(proxy)), direction.data());
  return {from.x[i], from.y[i], from.z[i]};
}

std::span<const PatchBranch> ProxySet::patch_tree(int proxy) const {
  const int first = impl_->skin.first_branch[static_cast<std::size_t>(proxy)], end = impl_->skin.first_branch[static_cast<std::size_t>(proxy) + 1];
  return {impl_->skin.tree.data() + first, static_cast<std::size_t>(end - first)};
}

Ball ProxySet::ball(int proxy, const PatchBranch& branch) const {
  const ProxyState& moved = state(proxy);
  return {moved.linear * branch.centre + moved.offset, moved.stretch * branch.radius + moved.residual};
}

double ProxySet::most_along(int proxy, const Vec3& direction) const {
  return proxy::most_along(impl_->corners.read(impl_->first_corner[static_cast<std::size_t>(proxy)]), padded(corner_count(proxy)), direction.data());
}

bool ProxySet::apart(int proxy, const Ball& ball, double margin, int steps, Vec3& witness) const {
  return ball_apart(impl_->corners.read(impl_->first_corner[static_cast<std::size_t>(proxy)]), padded(corner_count(proxy)), ball.centre.data(), ball.radius + margin, steps,
                    witness.data());
}

std::span<const SkinPatch> ProxySet::patches(int proxy) const {
  const int first = impl_->skin.first_of_proxy[static_cast<std::size_t>(proxy)], end = impl_->skin.first_of_proxy[static_cast<std::size_t>(proxy) + 1];
  return {impl_->skin.patches.data() + first, static_cast<std::size_t>(end - first)};
}

Ball ProxySet::ball(const SkinPatch& patch) const {
  const ProxyState& moved = state(patch.proxy);
  double most = 0.0;
  for (int i = patch.first_slot; i < patch.first_slot + patch.slot_count; ++i)
    most = std::max(most, impl_->squares[static_cast<std::size_t>(impl_->patch_slots[static_cast<std::size_t>(i)])]);
  const Vec3 centre = moved.linear * patch.centre + moved.offset;
  return {centre, moved.stretch * patch.radius + patch.weight_sum * std::sqrt(most) + 1e-13 * centre.cwiseAbs().maxCoeff()};
}

// Area vectors turn with the cofactors: n da = cof(F) N dA (Nanson).
Vec3 ProxySet::area(const SkinPatch& patch) const {
  const Mat3& F = state(patch.proxy).linear;
  return patch.area.x() * F.col(1).cross(F.col(2)) + patch.area.y() * F.col(2).cross(F.col(0)) + patch.area.z() * F.col(0).cross(F.col(1));
}

std::span<const int> ProxySet::faces(const SkinPatch& patch) const {
  return {impl_->skin.faces.data() + patch.first_face, static_cast<std::size_t>(patch.face_count)};
}

}  // namespace palpate::proxy
