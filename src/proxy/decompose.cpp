#include "proxy/decompose.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "palpate/core/error.h"
#include "proxy/convex_hull.h"
#include "proxy/hull_quality.h"
#include "proxy/owners.h"
#include "proxy/skin_clusters.h"

namespace palpate::proxy {
namespace {

void check(const LayeredModel& model, const DecomposeOptions& options) {
  if (model.skin.faces.cols() == 0) fail("convex decomposition: model \"{}\" has no skin", model.name);
  if (options.count < 1) fail("convex decomposition: count = {} must be at least 1", options.count);
  if (options.max_corners < 4)
    fail("convex decomposition: max_corners = {} must be at least 4", options.max_corners);
  if (!(options.normal_weight >= 0.0) || !std::isfinite(options.normal_weight))
    fail("convex decomposition: normal weight = {} must not be negative", options.normal_weight);
  if (!(options.tolerance >= 0.0))
    fail("convex decomposition: tolerance = {} must not be negative", options.tolerance);
  if (model.tets.tets.cols() > 0 && model.embedding.size() != model.skin.vertices.cols())
    fail("convex decomposition of \"{}\": only {} of {} skin vertices are embedded; all must be", model.name,
         model.embedding.size(), model.skin.vertices.cols());
}

/// Returns the proxy that holds most of a face's vertices; of three different proxies the first.  Every
/// face of the skin then has a proxy that holds its three vertices.
int majority(const std::array<int, 3>& of_vertex) {
  const auto [a, b, c] = of_vertex;
  return b == c ? b : a == b || a == c ? a : std::min({a, b, c});
}

void take_faces(const TriMesh& skin, const std::vector<int>& cluster, std::vector<ProxyHull>& proxies) {
  for (std::size_t v = 0; v < cluster.size(); ++v)
    proxies[static_cast<std::size_t>(cluster[v])].members.push_back(static_cast<int>(v));
  for (Eigen::Index f = 0; f < skin.faces.cols(); ++f) {
    const auto of = [&](int k) { return cluster[static_cast<std::size_t>(skin.faces(k, f))]; };
    auto& members = proxies[static_cast<std::size_t>(majority({of(0), of(1), of(2)}))].members;
    for (int k = 0; k < 3; ++k) members.push_back(skin.faces(k, f));
  }
  for (ProxyHull& proxy : proxies) {
    std::sort(proxy.members.begin(), proxy.members.end());
    proxy.members.erase(std::unique(proxy.members.begin(), proxy.members.end()), proxy.members.end());
  }
}

/// Returns the nodes of the tetrahedra that each proxy owns, ascending.
std::vector<std::vector<int>> owned_nodes(const LayeredModel& model, const std::vector<ProxyHull>& proxies) {
  std::vector<std::vector<int>> nodes(proxies.size());
  if (model.tets.tets.cols() == 0) return nodes;
  const auto owner = owner_of_tets(model.tets.tets, model.tets.nodes.cols(), model.embedding,
                                   owner_of_vertices(model.skin.vertices.cols(), proxies));
  for (std::size_t t = 0; t < owner.size(); ++t)
    for (int k = 0; k < 4; ++k)
      nodes[static_cast<std::size_t>(owner[t])].push_back(model.tets.tets(k, static_cast<Eigen::Index>(t)));
  for (auto& list : nodes) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return nodes;
}

}  // namespace

std::vector<ProxyHull> decompose(const LayeredModel& model, const DecomposeOptions& options,
                                 DecomposeReport* report) {
  check(model, options);
  const Points& skin = model.skin.vertices;
  const double size = (skin.rowwise().maxCoeff() - skin.rowwise().minCoeff()).norm();
  const std::vector<int> bone = nearest_bone(model.skeleton, skin);
  const std::vector<int> cluster = skin_clusters(model.skin, bone, options.count, options.normal_weight);
  std::vector<ProxyHull> proxies(
      static_cast<std::size_t>(1 + *std::max_element(cluster.begin(), cluster.end())));
  if (!model.skeleton.bones.empty())
    for (std::size_t v = 0; v < cluster.size(); ++v)
      proxies[static_cast<std::size_t>(cluster[v])].bone = bone[v];
  take_faces(model.skin, cluster, proxies);

  const auto nodes = owned_nodes(model, proxies);
  for (std::size_t p = 0; p < proxies.size(); ++p) {
    Points points(3, static_cast<Eigen::Index>(proxies[p].members.size() + nodes[p].size()));
    points.leftCols(static_cast<Eigen::Index>(proxies[p].members.size())) =
        skin(Eigen::all, proxies[p].members);
    points.rightCols(static_cast<Eigen::Index>(nodes[p].size())) = model.tets.nodes(Eigen::all, nodes[p]);
    proxies[p].corners =
        points(Eigen::all, greedy_corners(points, options.max_corners, options.tolerance * size));
  }
  if (report) *report = decompose_report(model.skin, proxies);
  return proxies;
}

}  // namespace palpate::proxy
