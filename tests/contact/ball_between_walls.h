#pragma once
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "surfaces.h"

namespace contact_tests {

/// A ball of radius 1 that is pressed into several walls at once: its skin in as many proxies, each about one
/// wall; the walls in one.
struct BallBetweenWalls {
  std::vector<Vec3> normal;   ///< of each wall's face, towards the ball
  std::vector<double> depth;  ///< of the ball in it
  LayeredModel ball, walls;
  dynamics::State state;
  contact::NodeSurface surface;

  BallBetweenWalls(std::vector<Vec3> normals, std::vector<double> depths)
      : normal(std::move(normals)), depth(std::move(depths)) {
    ball.tets = mesh::ball(1.0, 0.45);
    ball.skin = mesh::sphere(1.0, 40);
    ball.embedding = mesh::embed(ball.tets, ball.skin.vertices);
    ball.proxies.resize(normal.size());
    cut_in_sectors();
    build_walls();
    dynamics::BlockSpec nodes;
    nodes.name = "ball";
    nodes.q_size = nodes.u_size = static_cast<int>(ball.tets.nodes.size());
    surface.block_id = state.insert(nodes, Eigen::Map<const VecX>(ball.tets.nodes.data(), nodes.q_size),
                                    VecX::Zero(nodes.u_size));
    surface.faces = ball.skin.faces;
    surface.embedding = ball.embedding;
    surface.tets = ball.tets.tets;
  }

  double distance(const Vec3& x, std::size_t wall) const {  // of the ball's skin, above a wall's face
    return normal[wall].dot(x) + 1.0 - depth[wall];
  }

  /// What of the skin's polyhedron is beyond a wall's face: over each triangle the integral of the depth, of
  /// one that the face cuts over what is left of it, in triangles, where the depth is linear.
  double overlap(std::size_t wall) const {
    double volume = 0.0;
    for (const auto corner : ball.skin.faces.colwise()) {
      std::vector<Vec3> inside;
      for (int k = 0; k < 3; ++k) {
        const Vec3 p = ball.skin.vertices.col(corner[k]), q = ball.skin.vertices.col(corner[(k + 1) % 3]);
        const double at_p = distance(p, wall), at_q = distance(q, wall);
        if (at_p < 0.0) inside.push_back(p);
        if ((at_p < 0.0) != (at_q < 0.0)) inside.push_back(p + at_p / (at_p - at_q) * (q - p));
      }
      for (std::size_t k = 2; k < inside.size(); ++k) {
        const Vec3 area = 0.5 * (inside[k - 1] - inside[0]).cross(inside[k] - inside[0]);
        volume += area.dot(normal[wall]) / 3.0 *
                  (distance(inside[0], wall) + distance(inside[k - 1], wall) + distance(inside[k], wall));
      }
    }
    return volume;
  }

  std::unique_ptr<contact::SampleSource> source(double wanted, double shift_u, double shift_v) const {
    contact::ImageOptions options;
    options.pixels = 1024;
    options.quadrature_error = wanted;
    options.candidate_gap = 0.002;
    options.shift_u = shift_u;
    options.shift_v = shift_v;
    return contact::make_image_source(surface, std::make_shared<proxy::ProxySet>(ball), walls.skin,
                                      std::make_shared<proxy::ProxySet>(walls), 0, contact::fixed_frame(),
                                      options);
  }

 private:
  static void bound(ProxyHull& hull, const Points& vertices) {
    const Points points = vertices(Eigen::all, hull.members);
    const Vec3 low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    hull.corners.resize(3, 8);
    for (int i = 0; i < 8; ++i)
      hull.corners.col(i) =
          Vec3(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
  }
  /// One proxy about each wall.
  void cut_in_sectors() {
    std::vector<std::set<int>> members(normal.size());
    for (const auto corner : ball.skin.faces.colwise()) {
      Vec3 middle = Vec3::Zero();
      for (const int v : corner) middle += ball.skin.vertices.col(v) / 3.0;
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < normal.size(); ++i)
        if (normal[i].dot(middle) < normal[nearest].dot(middle)) nearest = i;
      members[nearest].insert(corner.begin(), corner.end());
    }
    for (std::size_t i = 0; i < normal.size(); ++i) {
      ball.proxies[i].members.assign(members[i].begin(), members[i].end());
      bound(ball.proxies[i], ball.skin.vertices);
    }
  }
  /// The slabs in one proxy, whose hull is full of the ball.
  void build_walls() {
    const TriMesh slab = mesh::box_surface(Vec3(1.1, 1.1, 0.3), {8, 8, 2});
    const Eigen::Index vertices = slab.vertices.cols(), faces = slab.faces.cols();
    const auto count = static_cast<Eigen::Index>(normal.size());
    walls.skin.vertices.resize(3, count * vertices);
    walls.skin.faces.resize(3, count * faces);
    for (std::size_t i = 0; i < normal.size(); ++i) {
      const Quat turn = Quat::FromTwoVectors(Vec3::UnitZ(), normal[i]);
      const auto at = static_cast<Eigen::Index>(i);
      for (Eigen::Index v = 0; v < vertices; ++v)
        walls.skin.vertices.col(at * vertices + v) =
            turn * Vec3(slab.vertices.col(v)) - (1.0 - depth[i] + 0.15) * normal[i];
      walls.skin.faces.middleCols(at * faces, faces) = slab.faces.array() + static_cast<int>(at * vertices);
    }
    ProxyHull all;
    all.members.resize(static_cast<std::size_t>(walls.skin.vertices.cols()));
    std::iota(all.members.begin(), all.members.end(), 0);
    bound(all, walls.skin.vertices);
    walls.proxies = {all};
  }
};

}  // namespace contact_tests
