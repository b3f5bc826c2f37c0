#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/pose.h"
#include "palpate/mesh/generators.h"
#include "proxy/decompose_solid.h"
#include "proxy/pruner.h"
#include "proxy/pruning.h"
#include "store/model_file.h"

/// The paper's models in contact as in its figures: two pumpkins in contact, the head touched by a sphere at
/// the bridge of the nose, the human at the leg. A touch moves in and out once in `kPhases` queries, and
/// dents the body.
namespace touch {

using namespace palpate;
using pruning::true_patch;

inline constexpr int kPhases = 8;
/// From 0 to 1 and back.
inline double pressed(int phase) { return 0.5 - 0.5 * std::cos(2 * M_PI * phase / kPhases); }

struct Case {
  LayeredModel a, b;
  Vec3 place = Vec3::Zero();       ///< place of contact
  Vec3 inward = Vec3::Zero();      ///< unit vector into a
  double size = 0.0;               ///< size of the dent [m]
  double least = 0.0, most = 0.0;  ///< depth of overlap at the first and the middle phase [m]
  double gap = 0.0;                ///< mean edge of a's skin, the default of a scene [m]

  bool b_is_soft() const { return b.tets.tets.cols() > 0; }

  /// Nodes of a, pushed in along `inward` by a Gaussian dent half as deep as b's depth.
  Points nodes_a(int phase) const { return dented(a.tets.nodes, inward, phase); }
  /// Nodes of a soft b, moved to the depth of the phase and dented in the opposite direction.
  Points nodes_b(int phase) const {
    const Points dent = dented(b.tets.nodes, -inward, phase);
    return dent.colwise() + depth(phase) * inward;
  }
  Pose pose_b(int phase) const { return {Quat::Identity(), depth(phase) * inward}; }

  double depth(int phase) const { return least + (most - least) * pressed(phase); }

 private:
  Points dented(Points nodes, const Vec3& along, int phase) const {
    for (Eigen::Index n = 0; n < nodes.cols(); ++n)
      nodes.col(n) +=
          0.25 * depth(phase) * std::exp(-(nodes.col(n) - place).squaredNorm() / (2 * size * size)) * along;
    return nodes;
  }
};

inline double mean_edge(const TriMesh& skin) {
  double sum = 0.0;
  for (Eigen::Index f = 0; f < skin.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      sum += (skin.vertices.col(skin.faces(k, f)) - skin.vertices.col(skin.faces((k + 1) % 3, f))).norm();
  return sum / static_cast<double>(3 * skin.faces.cols());
}

/// Adds a rigid ball that touches a's skin from the front (along y), where a line through (x, z) first hits
/// it; depth 0.
inline void add_ball(Case& out, double radius, double x, double z) {
  const double gap = mean_edge(out.a.skin);
  Eigen::Index nearest = -1;
  for (Eigen::Index v = 0; v < out.a.skin.vertices.cols(); ++v) {
    const Vec3 p = out.a.skin.vertices.col(v);
    if (std::hypot(p.x() - x, p.z() - z) < 2 * gap &&
        (nearest < 0 || p.y() < out.a.skin.vertices(1, nearest)))
      nearest = v;
  }
  PALPATE_CHECK(nearest >= 0, "no skin at x = {}, z = {}", x, z);
  out.place = out.a.skin.vertices.col(nearest);
  out.inward = Vec3::UnitY();
  out.b.name = "ball";
  out.b.skin = mesh::sphere(radius, 12);
  out.b.skin.vertices.colwise() += out.place - radius * out.inward;
  out.b.proxies = proxy::decompose_solid(out.b.skin);
  out.size = radius;
  out.gap = gap;
}

inline Case head(const std::string& folder) {
  Case out;
  out.a = store::read_model(folder + "/head.h5").model;
  add_ball(out, 0.012, 0.0, 0.0);
  out.least = 0.001;
  out.most = 0.006;
  return out;
}

/// The human, touched at the middle of the left shank.
inline Case human(const std::string& folder) {
  Case out;
  out.a = store::read_model(folder + "/human.h5").model;
  const auto& bones = out.a.skeleton.bones;
  const auto shank = std::find_if(bones.begin(), bones.end(), [](const Bone& bone) {
    return bone.name.find("shank") != std::string::npos;
  });
  PALPATE_CHECK(shank != bones.end(), "the human has no shank");
  const Vec3 middle = 0.5 * (shank->head + shank->tail);
  add_ball(out, 0.03, middle.x(), middle.z());
  out.least = 0.002;
  out.most = 0.012;
  return out;
}

/// Two pumpkins side by side: the second is the first rotated by 180 degrees about z, so that their extreme
/// points along x touch.
inline Case pumpkins(const std::string& folder) {
  Case out;
  out.a = store::read_model(folder + "/pumpkin.h5").model;
  Eigen::Index farthest = 0;
  out.a.skin.vertices.row(0).maxCoeff(&farthest);
  out.place = out.a.skin.vertices.col(farthest);
  out.inward = -Vec3::UnitX();
  out.b = out.a;
  const Vec3 shift(2 * out.place.x(), 2 * out.place.y(), 0.0);
  const auto rotate = [&](Points& points) {
    points.topRows<2>() *= -1.0;
    points.colwise() += shift;
  };
  rotate(out.b.tets.nodes);
  rotate(out.b.skin.vertices);
  for (ProxyHull& hull : out.b.proxies) rotate(hull.corners);
  out.size = 0.04;
  out.least = 0.001;
  out.most = 0.008;
  out.gap = mean_edge(out.a.skin);
  return out;
}

/// Both sides of a case as the pruner requires them.
struct Bodies {
  const Case& touch;
  proxy::ProxySet a, b;
  std::vector<Points> nodes_a, nodes_b;

  // patch size of a tool, as in rigid_proxies
  explicit Bodies(const Case& c) : touch(c), a(c.a), b(c.b, {.patch_faces = c.b_is_soft() ? 0 : 16}) {
    for (int i = 0; i < kPhases; ++i) {
      nodes_a.push_back(c.nodes_a(i));
      if (c.b_is_soft()) nodes_b.push_back(c.nodes_b(i));
    }
  }
  void update(int phase) {
    a.update(nodes_a[static_cast<std::size_t>(phase)]);
    if (touch.b_is_soft())
      b.update(nodes_b[static_cast<std::size_t>(phase)]);
    else
      b.update(touch.pose_b(phase));
  }
};

/// Skins of both bodies at a phase.
struct Skins {
  Points a, b;
  Skins(const Case& c, int phase) {
    mesh::evaluate(c.a.embedding, c.a.tets.tets, c.nodes_a(phase), a);
    if (c.b_is_soft())
      mesh::evaluate(c.b.embedding, c.b.tets.tets, c.nodes_b(phase), b);
    else
      b = c.b.skin.vertices.colwise() + c.pose_b(phase).translation;
  }
};

}  // namespace touch
