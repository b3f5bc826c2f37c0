#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>

#include "core/counters.h"
#include "palpate/core/error.h"
#include "proxy/hull.h"
#include "proxy/owners.h"
#include "proxy/proxy_set_impl.h"

namespace palpate::proxy {
namespace {

std::vector<int> sorted_unique(std::vector<int> list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

}  // namespace

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
  if (Eigen::SelfAdjointEigenSolver<Mat3>(M, Eigen::EigenvaluesOnly).eigenvalues()[0] <= kFlat * M.trace())
    M += kFlat * M.trace() * Mat3::Identity();
  for (int i = 0; i < cloud.lanes; ++i)
    node.push_back(nodes[static_cast<std::size_t>(i < cloud.count ? i : 0)]);
  rest_nodes.append(arm);
  coefficients.append_padded_with_zero(M.inverse() * arm);
  largest_cloud = std::max(largest_cloud, cloud.lanes);
  return cloud;
}

/// Collects for each patch the slots of the nodes in which its vertices are embedded.
void ProxySet::Impl::add_patch_nodes(const LayeredModel& model) {
  std::vector<int> slot_of_node(static_cast<std::size_t>(node_count), -1);
  int proxy = -1;
  for (SkinPatch& patch : skin.patches) {
    if (patch.proxy != proxy) {
      proxy = patch.proxy;
      const Cloud& cloud = own[static_cast<std::size_t>(proxy)];
      for (int i = 0; i < cloud.count; ++i)
        slot_of_node[static_cast<std::size_t>(node[static_cast<std::size_t>(cloud.first + i)])] =
            cloud.first + i;
    }
    std::vector<int> slots;
    for (int f = patch.first_face; f < patch.first_face + patch.face_count; ++f)
      for (int k = 0; k < 3; ++k) {
        const int v = model.skin.faces(k, skin.faces[static_cast<std::size_t>(f)]);
        patch.weight_sum = std::max(patch.weight_sum, model.embedding.weights.col(v).cwiseAbs().sum());
        for (int n = 0; n < 4; ++n)
          slots.push_back(slot_of_node[static_cast<std::size_t>(
              model.tets.tets(n, model.embedding.tet[static_cast<std::size_t>(v)]))]);
      }
    slots = sorted_unique(std::move(slots));
    patch.first_slot = static_cast<int>(patch_slots.size());
    patch.slot_count = static_cast<int>(slots.size());
    patch_slots.insert(patch_slots.end(), slots.begin(), slots.end());
  }
}

/// Stores the patches' balls as columns.
void ProxySet::Impl::add_balls() {
  ball_of_patch.resize(skin.patches.size());
  std::size_t most = 0;
  for (int p = 0; p < count; ++p) {
    const int first = skin.first_of_proxy[static_cast<std::size_t>(p)],
              patches = skin.first_of_proxy[static_cast<std::size_t>(p) + 1] - first;
    first_ball.push_back(rest_balls.size());
    Points centres(3, patches);
    for (int i = 0; i < patches; ++i) {
      const SkinPatch& patch = skin.patches[static_cast<std::size_t>(first + i)];
      centres.col(i) = patch.centre;
      ball_of_patch[static_cast<std::size_t>(first + i)] = first_ball.back() + i;
      rest_radius.push_back(patch.radius);
    }
    rest_balls.append(centres);
    rest_radius.resize(static_cast<std::size_t>(rest_balls.size()));
    most = std::max(most, static_cast<std::size_t>(padded(patches)));
  }
  balls = rest_balls;
  radius = rest_radius;
  balls_at.assign(static_cast<std::size_t>(count), -1);
  measured_at.assign(skin.patches.size(), -1);
  near.resize(most);
  near_balls.resize(static_cast<int>(most));
  near_radius.resize(most);
  near_patch.resize(most);
}

/// Nodes of a soft body, by proxy and by bone.
struct ProxySet::Impl::Nodes {
  std::vector<std::vector<int>> owned;  ///< per proxy: nodes of its tetrahedra
  std::vector<Cloud> of_bone;           ///< nodes that a bone carries; empty: too few, or not followed
};

ProxySet::Impl::Nodes ProxySet::Impl::divide_nodes(const LayeredModel& model) {
  Nodes out{std::vector<std::vector<int>>(model.proxies.size()),
            std::vector<Cloud>(model.skeleton.bones.size())};
  if (!soft) return out;
  const auto owner = owner_of_tets(model.tets.tets, node_count, model.embedding,
                                   owner_of_vertices(model.skin.vertices.cols(), model.proxies));
  for (std::size_t t = 0; t < owner.size(); ++t)
    for (int k = 0; k < 4; ++k)
      out.owned[static_cast<std::size_t>(owner[t])].push_back(
          model.tets.tets(k, static_cast<Eigen::Index>(t)));
  if (options.follow != Follow::kRigid || model.bone_of_node.empty()) return out;
  for (std::size_t b = 0; b < out.of_bone.size(); ++b) {
    std::vector<int> carried;
    for (std::size_t n = 0; n < model.bone_of_node.size(); ++n)
      if (model.bone_of_node[n] == static_cast<int>(b)) carried.push_back(static_cast<int>(n));
    if (carried.size() >= 4) out.of_bone[b] = add_cloud(model.tets, carried);
  }
  return out;
}

void ProxySet::Impl::add_proxy(const LayeredModel& model, int p, Nodes& all) {
  const auto at = static_cast<std::size_t>(p);
  const ProxyHull& hull = model.proxies[at];
  if (hull.corners.cols() == 0 || !hull.corners.allFinite())
    fail("body \"{}\": proxy {} has no corners, or a corner that is not finite", model.name, p);
  if (hull.bone >= static_cast<int>(model.skeleton.bones.size()))
    fail("body \"{}\": proxy {} is attached to bone {}, but there are {} bones", model.name, p, hull.bone,
         model.skeleton.bones.size());
  bone.push_back(hull.bone);
  first_corner.push_back(rest_corners.size());
  corner_count.push_back(static_cast<int>(hull.corners.cols()));
  rest_corners.append(hull.corners);
  rest_centre.push_back(hull.corners.rowwise().mean());
  const std::vector<int> owned = sorted_unique(std::move(all.owned[at]));
  std::vector<int> nodes;
  double farthest = hull.outside, sum = 1.0;
  const Hull shape(hull.corners);
  Hull one;
  const auto reach_for = [&](const Vec3& x) {
    one.assign(x, Vec3::Zero(), 1.0);
    farthest = std::max(farthest, nearest_difference(one, shape).norm());
  };
  for (const int v : hull.members) {
    reach_for(model.skin.vertices.col(v));
    if (!soft) continue;
    sum = std::max(sum, model.embedding.weights.col(v).cwiseAbs().sum());
    for (int k = 0; k < 4; ++k)
      nodes.push_back(model.tets.tets(k, model.embedding.tet[static_cast<std::size_t>(v)]));
  }
  for (const int n : owned) reach_for(model.tets.nodes.col(n));
  const double size = (hull.corners.rowwise().maxCoeff() - hull.corners.rowwise().minCoeff()).norm();
  outside.push_back(farthest + 1e-9 * size);  // accuracy of the distance algorithm
  weight_sum.push_back(sum);
  if (!soft) return;
  nodes.insert(nodes.end(), owned.begin(), owned.end());
  own.push_back(add_cloud(model.tets, sorted_unique(std::move(nodes))));
  const bool by_bone = hull.bone >= 0 && hull.bone < static_cast<int>(all.of_bone.size()) &&
                       all.of_bone[static_cast<std::size_t>(hull.bone)].count > 0;
  guide.push_back(by_bone ? all.of_bone[static_cast<std::size_t>(hull.bone)] : own.back());
}

/// Marks proxies that share a vertex.
void ProxySet::Impl::find_adjacent(const LayeredModel& model) {
  adjacent.assign(static_cast<std::size_t>(count) * static_cast<std::size_t>(count), 0);
  std::vector<std::vector<int>> at_vertex(static_cast<std::size_t>(model.skin.vertices.cols()));
  for (int p = 0; p < count; ++p) {
    adjacent[static_cast<std::size_t>(p * count + p)] = 1;
    for (const int v : model.proxies[static_cast<std::size_t>(p)].members)
      at_vertex[static_cast<std::size_t>(v)].push_back(p);
  }
  for (const auto& list : at_vertex)
    for (const int p : list)
      for (const int q : list) adjacent[static_cast<std::size_t>(p * count + q)] = 1;
}

ProxySet::ProxySet(const LayeredModel& model, const ProxySetOptions& options)
    : impl_(std::make_unique<Impl>()) {
  Impl& s = *impl_;
  counters::count("proxy.proxy_set");
  if (model.proxies.empty()) fail("body \"{}\" has no proxies", model.name);
  if (options.patch_faces < 0)
    fail("body \"{}\": patch_faces = {} must not be negative; 0 chooses 1/2000 of the skin", model.name,
         options.patch_faces);
  s.options = options;
  if (options.patch_faces == 0)
    s.options.patch_faces = std::clamp(static_cast<int>(model.skin.faces.cols() / 2000), 4, 64);
  s.soft = model.tets.tets.cols() > 0;
  s.node_count = model.tets.nodes.cols();
  s.count = static_cast<int>(model.proxies.size());
  const Eigen::Index vertices = model.skin.vertices.cols();
  if (s.soft && model.embedding.size() != vertices)
    fail("body \"{}\": only {} of {} skin vertices are embedded; all must be", model.name,
         model.embedding.size(), vertices);
  const std::vector<int> owner_of_face = owner_of_faces(model.skin.faces, vertices, model.proxies);
  s.skin = skin_patches(model.skin, owner_of_face, s.count, s.options.patch_faces);

  Impl::Nodes nodes = s.divide_nodes(model);
  s.states.resize(model.proxies.size());
  Points middle(3, s.count);
  for (int p = 0; p < s.count; ++p) {
    s.add_proxy(model, p, nodes);
    middle.col(p) = s.rest_centre.back();
  }
  s.corners = s.rest_corners;
  s.centre = s.rest_centre;
  s.gathered.resize(s.largest_cloud);
  s.squares.resize(s.node.size());
  if (s.soft) s.add_patch_nodes(model);
  s.add_balls();
  s.fitted_at.assign(static_cast<std::size_t>(s.count), -1);
  s.boxes.resize(static_cast<std::size_t>(s.count));
  s.kept_boxes = s.boxes;
  if (s.soft) s.motion.resize(static_cast<int>(s.node_count));
  s.find_adjacent(model);
  s.tree = proxy_tree(model.skeleton, model.proxies, middle);
  s.add_motions();
  if (s.soft)
    update(model.tets.nodes);
  else
    update(Pose{});
}

}  // namespace palpate::proxy
