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

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/core/polar.h"
#include "proxy/hull.h"
#include "proxy/lanes.h"
#include "proxy/owners.h"
#include "proxy/skin_patches.h"

namespace palpate::proxy {
namespace {

/// Points coordinate by coordinate, set after set, each filled up to whole lanes with its first.
struct Table {
  std::vector<double> x, y, z;

  void append(const Points& points) {
    for (int i = 0; i < padded(static_cast<int>(points.cols())); ++i) {
      const Vec3 p = points.col(i < points.cols() ? i : 0);
      x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
    }
  }
  void append_padded_with_zero(const Points& points) {
    for (int i = 0; i < padded(static_cast<int>(points.cols())); ++i) {
      const Vec3 p = i < points.cols() ? Vec3(points.col(i)) : Vec3(Vec3::Zero());
      x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
    }
  }
  Columns read(int first) const { return {x.data() + first, y.data() + first, z.data() + first}; }
  MutableColumns write(int first) { return {x.data() + first, y.data() + first, z.data() + first}; }
  int size() const { return static_cast<int>(x.size()); }
};

/// Nodes whose motion is fitted or bounded.
struct Cloud {
  int first = 0, count = 0, lanes = 0;  // in the tables of nodes
  Vec3 middle = Vec3::Zero();           // of the rest positions
  Mat3 spread = Mat3::Zero();           // M
};

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

std::vector<int> sorted_unique(std::vector<int> list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

}  // namespace

struct ProxySet::Impl {
  ProxySetOptions options;
  bool soft = false;
  Eigen::Index node_count = 0;
  int count = 0, largest_cloud = 0;
  std::vector<int> bone;
  std::vector<ProxyState> states;
  std::vector<Vec3> rest_centre, centre;
  std::vector<double> outside, weight_sum;   // e and s of each proxy
  std::vector<Cloud> own, guide;             // what bounds it; what moves it
  std::vector<int> first_corner, corner_count;
  Table rest_corners, corners;
  std::vector<int> node;                     // of each slot of the node tables
  Table rest_nodes, coefficients;            // from the cloud's middle; q
  Table gathered;                            // positions of one cloud
  std::vector<double> squares;               // |d|^2 of every slot
  std::vector<char> adjacent;                // count x count
  SkinPatches skin;
  std::vector<int> patch_slots;              // slots of each patch's nodes
  std::vector<ProxyBranch> tree;

  Cloud add_cloud(const TetMesh& tets, const std::vector<int>& nodes);
  void add_patch_nodes(const LayeredModel& model);
  void fit(const Eigen::Ref<const Points>& nodes, const Cloud& cloud, ProxyState& state);
  void gather(const Eigen::Ref<const Points>& nodes, const Cloud& cloud, const Vec3& origin);
  void place(int proxy, double residual, double reach);
};

Cloud ProxySet::Impl::add_cloud(const TetMesh& tets, const std::vector<int>& nodes) {
  constexpr double kFlat = 1e-8;
  Cloud cloud;
  cloud.first = static_cast<int>(node.size());
  cloud.count = static_cast<int>(nodes.size());
  cloud.lanes = padded(cloud.count);
  const Points rest = tets.nodes(Eigen::all, nodes);
  cloud.middle = rest.rowwise().mean();
  const Points arm = rest.colwise() - cloud.middle;
  cloud.spread = arm * arm.transpose();
  Mat3 M = cloud.spread;
  if (Eigen::SelfAdjointEigenSolver<Mat3>(M, Eigen::EigenvaluesOnly).eigenvalues()[0] <= kFlat * M.trace()) M += kFlat * M.trace() * Mat3::Identity();
  for (int i = 0; i < cloud.lanes; ++i) node.push_back(nodes[static_cast<std::size_t>(i < cloud.count ? i : 0)]);
  rest_nodes.append(arm);
  coefficients.append_padded_with_zero(M.inverse() * arm);
  largest_cloud = std::max(largest_cloud, cloud.lanes);
  return cloud;
}

/// For each patch the slots of the nodes that its vertices hang on.
void ProxySet::Impl::add_patch_nodes(const LayeredModel& model) {
  std::vector<int> slot_of_node(static_cast<std::size_t>(node_count), -1);
  int proxy = -1;
  for (SkinPatch& patch : skin.patches) {
    if (patch.proxy != proxy) {
      proxy = patch.proxy;
      const Cloud& cloud = own[static_cast<std::size_t>(proxy)];
      for (int i = 0; i < cloud.count; ++i) slot_of_node[static_cast<std::size_t>(node[static_cast<std::size_t>(cloud.first + i)])] = cloud.first + i;
    }
    std::vector<int> slots;
    for (int f = patch.first_face; f < patch.first_face + patch.face_count; ++f)
      for (int k = 0; k < 3; ++k) {
        const int v = model.skin.faces(k, skin.faces[static_cast<std::size_t>(f)]);
        patch.weight_sum = std::max(patch.weight_sum, model.embedding.weights.col(v).cwiseAbs().sum());
        for (int n = 0; n < 4; ++n) slots.push_back(slot_of_node[static_cast<std::size_t>(model.tets.tets(n, model.embedding.tet[static_cast<std::size_t>(v)]))]);
      }
    slots = sorted_unique(std::move(slots));
    patch.first_slot = static_cast<int>(patch_slots.size());
    patch.slot_count = static_cast<int>(slots.size());
    patch_slots.insert(patch_slots.end(), slots.begin(), slots.end());
  }
}

ProxySet::ProxySet(const LayeredModel& model, const ProxySetOptions& options) : impl_(std::make_unique<Impl>()) {
  Impl& s = *impl_;
  counters::count("proxy.proxy_set");
  if (model.proxies.empty()) fail("body \"{}\": it has no proxies", model.name);
  if (options.patch_faces < 0) fail("body \"{}\": patches of {} faces; one at least, or 0 for a 3600th of the skin", model.name, options.patch_faces);
  s.options = options;
  if (options.patch_faces == 0) s.options.patch_faces = std::clamp(static_cast<int>(model.skin.faces.cols() / 3600), 4, 64);
  s.soft = model.tets.tets.cols() > 0;
  s.node_count = model.tets.nodes.cols();
  s.count = static_cast<int>(model.proxies.size());
  const Eigen::Index vertices = model.skin.vertices.cols();
  if (s.soft && model.embedding.size() != vertices) fail("body \"{}\": {} of its {} skin vertices are embedded", model.name, model.embedding.size(), vertices);
  const std::vector<int> owner_of_face = owner_of_faces(model.skin.faces, vertices, model.proxies);
  s.skin = skin_patches(model.skin, owner_of_face, s.count, s.options.patch_faces);

  std::vector<std::vector<int>> nodes_of(model.proxies.size());
  std::vector<std::vector<int>> owned(model.proxies.size());
  std::vector<Cloud> of_bone(model.skeleton.bones.size());
  if (s.soft) {
    const auto owner = owner_of_tets(model.tets.tets, s.node_count, model.embedding, owner_of_vertices(vertices, model.proxies));
    for (std::size_t t = 0; t < owner.size(); ++t)
      for (int k = 0; k < 4; ++k) owned[static_cast<std::size_t>(owner[t])].push_back(model.tets.tets(k, static_cast<Eigen::Index>(t)));
    for (std::size_t b = 0; b < of_bone.size() && options.follow == Follow::kRigid && !model.bone_of_node.empty(); ++b) {
      std::vector<int> carried;
      for (std::size_t n = 0; n < model.bone_of_node.size(); ++n)
        if (model.bone_of_node[n] == static_cast<int>(b)) carried.push_back(static_cast<int>(n));
      if (carried.size() >= 4) of_bone[b] = s.add_cloud(model.tets, carried);
    }
  }
  s.states.resize(model.proxies.size());
  Points middle(3, s.count);
  for (int p = 0; p < s.count; ++p) {
    const auto at = static_cast<std::size_t>(p);
    const ProxyHull& hull = model.proxies[at];
    if (hull.corners.cols() == 0 || !hull.corners.allFinite()) fail("body \"{}\": proxy {} has no corners, or one that is not finite", model.name, p);
    s.bone.push_back(hull.bone);
    s.first_corner.push_back(s.rest_corners.size());
    s.corner_count.push_back(static_cast<int>(hull.corners.cols()));
    s.rest_corners.append(hull.corners);
    middle.col(p) = hull.corners.rowwise().mean();
    s.rest_centre.push_back(middle.col(p));
    owned[at] = sorted_unique(std::move(owned[at]));
    double outside = 0.0, sum = 1.0;
    const auto reach_for = [&](const Vec3& x) {
      const Points one = x;
      outside = std::max(outside, nearest_difference(Hull(one), Hull(hull.corners)).norm());
    };
    for (const int v : hull.members) {
      reach_for(model.skin.vertices.col(v));
      if (!s.soft) continue;
      sum = std::max(sum, model.embedding.weights.col(v).cwiseAbs().sum());
      for (int k = 0; k < 4; ++k) nodes_of[at].push_back(model.tets.tets(k, model.embedding.tet[static_cast<std::size_t>(v)]));
    }
    for (const int n : owned[at]) reach_for(model.tets.nodes.col(n));
    const double size = (hull.corners.rowwise().maxCoeff() - hull.corners.rowwise().minCoeff()).norm();
    s.outside.push_back(outside + 1e-9 * size);  // the distance algorithm's own accuracy
    s.weight_sum.push_back(sum);
    if (!s.soft) continue;
    nodes_of[at].insert(nodes_of[at].end(), owned[at].begin(), owned[at].end());
    s.own.push_back(s.add_cloud(model.tets, sorted_unique(std::move(nodes_of[at]))));
    const bool by_bone = hull.bone >= 0 && hull.bone < static_cast<int>(of_bone.size()) && of_bone[static_cast<std::size_t>(hull.bone)].count > 0;
    s.guide.push_back(by_bone ? of_bone[static_cast<std::size_t>(hull.bone)] : s.own.back());
  }
  s.corners = s.rest_corners;
  s.centre = s.rest_centre;
  for (auto* column : {&s.gathered.x, &s.gathered.y, &s.gathered.z}) column->resize(static_cast<std::size_t>(s.largest_cloud));
  s.squares.resize(s.node.size());
  if (s.soft) s.add_patch_nodes(model);

  s.adjacent.assign(static_cast<std::size_t>(s.count) * static_cast<std::size_t>(s.count), 0);
  std::vector<std::vector<int>> at_vertex(static_cast<std::size_t>(vertices));
  for (int p = 0; p < s.count; ++p) {
    s.adjacent[static_cast<std::size_t>(p * s.count + p)] = 1;
    for (const int v : model.proxies[static_cast<std::size_t>(p)].members) at_vertex[static_cast<std::size_t>(v)].push_back(p);
  }
  for (const auto& list : at_vertex)
    for (const int p : list)
      for (const int q : list) s.adjacent[static_cast<std::size_t>(p * s.count + q)] = 1;
  s.tree = proxy_tree(model.skeleton, model.proxies, middle);
  if (s.soft)
    update(model.tets.nodes);
  else
    update(Pose{});
}

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
  state.inflation = state.stretch * outside[at] + weight_sum[at] * residual + kRounding * reach;
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
