// Seen along the normal n, from b to a, a's skin faces down and b's skin faces up; they overlap where x_b
// lies above x_a. Three situations look like this:
//   contact         a's tissue begins at x_a and b's ends at x_b: both occupy the space in between;
//   own thickness   b's skin is the back of the tissue that begins at x_a: one tissue in between;
//   passed by       the tissue that begins at x_a ends below the tissue that ends at x_b, with air between:
//                   the tissue of b is above that of a, and they do not touch here.
// They differ in the end of the straight path from x_a to x_b if it is traced through the tetrahedra, from
// one to its neighbour across a face. In contact it ends inside a's tissue, at a point Y of the body at rest;
// in own thickness at X_b, the same point of the skin; in passing by it leaves the tissue before its end. The
// path from b is traced as well, and one path that ends inside is sufficient: if a thin part is enclosed by a
// thick one, only one of the paths ends inside. Where both are thinner than the overlap is deep, no path
// stays inside and no contact is detected.
//
// The distance of Y from X_b is compared with its distance from the path's start X_a. In own thickness
// |Y - X_b| is rounding, plus the skin's distance from the tetrahedra where these do not fill it. In contact
// Y lies below the skin at X_a and X_b lies on the skin, so that while |Y - X_a| is less than half of the
// tissue's thickness, |Y - X_b| is not less than Y's depth, |Y - X_a| cos(tilt of the skin against n). The
// threshold is half of |Y - X_a|. At rest every overlap of a skin that does not intersect itself is own
// thickness, with Y = X_b: there is no contact force at rest, whatever the search distance.
//
// The path may end outside the tetrahedra by as much as the skin does; there the last tetrahedron is
// extrapolated. A tetrahedron too flat to have weights ends the path, so that no spurious force arises.
#include "contact/self_contact_filter.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/counters.h"
#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

/// Returns, for each corner of each tetrahedron, the tetrahedron across the face opposite to it.
Tets neighbours(const Tets& tets) {
  struct Face {
    std::array<int, 3> nodes;
    int tet, corner;
  };
  std::vector<Face> faces;
  for (Eigen::Index t = 0; t < tets.cols(); ++t)
    for (int k = 0; k < 4; ++k) {
      std::array<int, 3> nodes{tets((k + 1) % 4, t), tets((k + 2) % 4, t), tets((k + 3) % 4, t)};
      std::sort(nodes.begin(), nodes.end());
      faces.push_back({nodes, static_cast<int>(t), k});
    }
  std::sort(faces.begin(), faces.end(), [](const Face& f, const Face& g) { return f.nodes < g.nodes; });
  Tets across = Tets::Constant(4, tets.cols(), -1);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i - 1].nodes != faces[i].nodes) continue;
    across(faces[i].corner, faces[i].tet) = faces[i - 1].tet;
    across(faces[i - 1].corner, faces[i - 1].tet) = faces[i].tet;
  }
  return across;
}

/// Computes the map from a position, relative to the first corner, to the weights of the other three corners.
/// Returns false where the tetrahedron is flat.
bool weights_of(const Tets& tets, const Points& nodes, int tet, Mat3& map) {
  constexpr double kFlat = 1e-6;  // Volume divided by the cube of the longest edge.
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = nodes.col(tets(k + 1, tet)) - nodes.col(tets(0, tet));
  const double size = edges.colwise().norm().maxCoeff();
  if (!(std::abs(edges.determinant()) > kFlat * size * size * size)) return false;
  map = edges.inverse();
  return true;
}

}  // namespace

SelfContactFilter::SelfContactFilter(const SurfaceState& skin, Points rest_nodes)
    : skin_(skin), rest_nodes_(std::move(rest_nodes)) {
  counters::count("contact.self_contact_filter");
  const NodeSurface& surface = skin.surface();
  PALPATE_CHECK(surface.node_of_vertex.empty() && surface.tets.cols() > 0,
                "self-contact needs a skin embedded in tetrahedra");
  PALPATE_CHECK(surface.tets.maxCoeff() < rest_nodes_.cols(), "self-contact: node {} of {}",
                surface.tets.maxCoeff(), rest_nodes_.cols());
  across_ = neighbours(surface.tets);
  mesh::evaluate(surface.embedding, surface.tets, rest_nodes_, rest_vertices_);
  // A negative weight is a distance outside the face opposite to its corner, in heights of that corner: 1 /
  // |gradient of the weight|.
  for (int v = 0; v < surface.embedding.size(); ++v) {
    if (surface.embedding.weights.col(v).minCoeff() >= 0.0) continue;
    Mat3 map;
    const int tet = surface.embedding.tet[static_cast<std::size_t>(v)];
    PALPATE_CHECK(weights_of(surface.tets, rest_nodes_, tet, map), "tetrahedron {} is flat at rest", tet);
    double off = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double gradient = k == 0 ? map.colwise().sum().norm() : map.row(k - 1).norm();
      off += std::max(0.0, -surface.embedding.weights(k, v)) / gradient;
    }
    skin_distance_ = std::max(skin_distance_, off);
  }
}

SkinPoint SelfContactFilter::point(int face, const Vec3& weights, const Vec3& world) const {
  const NodeSurface& surface = skin_.surface();
  const auto corner = surface.faces.col(face);
  Eigen::Index nearest = 0;
  weights.maxCoeff(&nearest);
  SkinPoint out{surface.embedding.tet[static_cast<std::size_t>(corner[nearest])], Vec3::Zero(), world};
  for (int k = 0; k < 3; ++k) out.rest += weights[k] * rest_vertices_.col(corner[k]);
  return out;
}

SelfContactFilter::Way SelfContactFilter::walk(int tet, const Vec3& from, const Vec3& to) const {
  constexpr int kMostSteps = 1000;
  constexpr double kGrazing = 1e-12;  // A smaller decrease of a weight over the whole path is rounding.
  const Tets& tets = skin_.surface().tets;
  Way way{0.0, tet, Eigen::Vector4d::Zero()};
  for (int step = 0; step < kMostSteps; ++step) {
    Mat3 map;
    if (!weights_of(tets, skin_.nodes(), way.tet, map)) return way;
    Eigen::Vector4d begin;
    const auto first = skin_.nodes().col(tets(0, way.tet));
    begin.tail<3>() = map * (from - first);
    begin[0] = 1.0 - begin.tail<3>().sum();
    way.end.tail<3>() = map * (to - first);
    way.end[0] = 1.0 - way.end.tail<3>().sum();
    int exit = -1;
    double at = 1.0;
    for (int k = 0; k < 4; ++k)
      if (const double fall = begin[k] - way.end[k]; fall > kGrazing && begin[k] < at * fall) {
        exit = k;
        at = begin[k] / fall;
      }
    way.inside = std::max(way.inside, at);
    if (exit < 0 || across_(exit, way.tet) < 0) return way;
    way.tet = across_(exit, way.tet);
  }
  return way;
}

bool SelfContactFilter::ends_elsewhere(const SkinPoint& from, const SkinPoint& to) const {
  constexpr double kRounding = 1e-6;
  const Way way = walk(from.tet, from.now, to.now);
  const double length = (to.now - from.now).norm();
  if ((1.0 - way.inside) * length > 2.0 * skin_distance_ + kRounding * length) return false;
  Vec3 end = Vec3::Zero();
  for (int k = 0; k < 4; ++k) end += way.end[k] * rest_nodes_.col(skin_.surface().tets(k, way.tet));
  return (end - to.rest).norm() > 0.5 * (end - from.rest).norm();
}

}  // namespace palpate::contact
