#pragma once
#include <map>

#include "fixture.h"
#include "palpate/mesh/generators.h"

namespace contact_tests {

inline constexpr double kPi = 3.14159265358979323846;

/// A latitude-longitude sphere, outward, poles on z.
inline TriMesh sphere(const Vec3& centre, double radius, int rings) {
  const int around = 2 * rings;
  TriMesh mesh;
  mesh.vertices.resize(3, (rings - 1) * around + 2);
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double theta = kPi * i / rings, phi = 2 * kPi * j / around;
      mesh.vertices.col((i - 1) * around + j) =
          centre +
          radius * Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    }
  const int north = (rings - 1) * around, south = north + 1;
  mesh.vertices.col(north) = centre + Vec3(0, 0, radius);
  mesh.vertices.col(south) = centre - Vec3(0, 0, radius);
  std::vector<Eigen::Vector3i> faces;
  const auto at = [&](int i, int j) { return (i - 1) * around + j % around; };
  for (int j = 0; j < around; ++j) {
    faces.emplace_back(north, at(1, j), at(1, j + 1));
    faces.emplace_back(south, at(rings - 1, j + 1), at(rings - 1, j));
    for (int i = 1; i + 1 < rings; ++i) {
      faces.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      faces.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  mesh.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.faces.col(static_cast<Eigen::Index>(f)) = faces[f];
  return mesh;
}

/// A flat block, 1 m wide and 0.5 m high, whose triangles are much larger than a ball of 5 cm.
inline TriMesh flat_block(int finer = 1) {
  return mesh::box_surface({1.0, 1.0, 0.5}, {10 * finer, 8 * finer, 4});
}

/// Closes a surface that has a border by a cone to `tip`, which becomes its last vertex.
inline TriMesh closed_by_cone(TriMesh open, const Vec3& tip) {
  std::map<std::pair<int, int>, int> edges;
  for (Eigen::Index f = 0; f < open.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) ++edges[{open.faces(k, f), open.faces((k + 1) % 3, f)}];
  const int last = static_cast<int>(open.vertices.cols());
  open.vertices.conservativeResize(3, last + 1);
  open.vertices.col(last) = tip;
  for (const auto& [edge, count] : edges) {
    if (edges.contains({edge.second, edge.first})) continue;
    open.faces.conservativeResize(3, open.faces.cols() + 1);
    open.faces.col(open.faces.cols() - 1) = Eigen::Vector3i(edge.second, edge.first, last);
  }
  return open;
}

/// A State whose nodes are a surface's vertices, after a block of two other nodes.
struct SurfaceWorld {
  dynamics::State state;
  contact::NodeSurface surface;

  explicit SurfaceWorld(const TriMesh& mesh) {
    dynamics::BlockSpec other;
    other.name = "other";
    other.q_size = other.u_size = 6;
    state.insert(other, VecX::Constant(6, 100.0), VecX::Zero(6));
    dynamics::BlockSpec nodes;
    nodes.name = "surface";
    nodes.q_size = nodes.u_size = static_cast<int>(3 * mesh.vertices.cols());
    surface.block_id = state.insert(nodes, Eigen::Map<const VecX>(mesh.vertices.data(), mesh.vertices.size()),
                                    VecX::Zero(nodes.u_size));
    surface.node_of_vertex.resize(static_cast<std::size_t>(mesh.vertices.cols()));
    for (std::size_t i = 0; i < surface.node_of_vertex.size(); ++i)
      surface.node_of_vertex[i] = static_cast<int>(i);
    surface.faces = mesh.faces;
  }
};

/// A coarse ball of tetrahedra, bent and stretched, that carries a fine sphere as its skin (parts of which
/// lie outside of the flat faces); after another block.
struct SkinWorld {
  TetMesh ball = mesh::ball(1.0, 0.45);
  TriMesh skin = mesh::sphere(1.0, 12);
  dynamics::State state;
  contact::NodeSurface surface;
  Points vertices;  ///< skin vertices, deformed

  SkinWorld() {
    dynamics::BlockSpec other;
    other.name = "other";
    other.q_size = other.u_size = 6;
    state.insert(other, VecX::Constant(6, 100.0), VecX::Zero(6));
    Points bent = ball.nodes;
    for (auto x : bent.colwise())
      x = Vec3(1.2 * x.x() + 0.2 * x.z() * x.z(), 0.9 * x.y() + 0.1 * x.x() * x.z(),
               x.z() + 0.15 * x.x() * x.x());
    dynamics::BlockSpec nodes;
    nodes.name = "ball";
    nodes.q_size = nodes.u_size = static_cast<int>(bent.size());
    VecX speeds(bent.size());
    for (Eigen::Index i = 0; i < speeds.size(); ++i) speeds[i] = std::sin(1.0 + static_cast<double>(i));
    surface.block_id = state.insert(nodes, Eigen::Map<const VecX>(bent.data(), bent.size()), speeds);
    surface.faces = skin.faces;
    surface.embedding = mesh::embed(ball, skin.vertices);
    surface.tets = ball.tets;
    mesh::evaluate(surface.embedding, ball.tets, bent, vertices);
  }
};

/// Position of a point on weighted nodes.
inline Vec3 point_on_nodes(const contact::SurfacePoint& p, const dynamics::StateView& state) {
  Vec3 x = p.offset;
  for (int k = 0; k < p.count; ++k)
    x += p.weight[static_cast<std::size_t>(k)] * state.position(p.node[static_cast<std::size_t>(k)]);
  return x;
}

/// Force and moment about the origin on side a, at unit stiffness per area.
struct Total {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  int pressed = 0;
};
inline Total total(const std::vector<contact::ContactSample>& samples, const dynamics::StateView& state) {
  Total out;
  for (const auto& s : samples) {
    if (s.gap >= 0.0) continue;
    const Vec3 force = -s.gap * s.area * s.normal;
    out.force += force;
    out.moment += point_on_nodes(s.a, state).cross(force);
    ++out.pressed;
  }
  return out;
}

}  // namespace contact_tests
