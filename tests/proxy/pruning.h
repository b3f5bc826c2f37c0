#pragma once
#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <span>
#include <vector>

#include "mesh/layered_model.h"
#include "palpate/core/pose.h"
#include "proxy/decompose.h"
#include "proxy/pruner.h"

/// Faces passed on by a pruner, compared with contact by brute force.
namespace pruning {

using namespace palpate;

inline LayeredModel cut(LayeredModel model, int count) {
  model.proxies = proxy::decompose(model, {.count = count});
  return model;
}

/// A soft body at given node positions, with its skin.
struct Placed {
  const LayeredModel& model;
  proxy::ProxySet set;
  Points nodes, skin;

  explicit Placed(const LayeredModel& m) : model(m), set(m) { place(Pose{}, 0.0, 0); }
  /// Places it rigidly, after waves of the given amplitude through it.
  void place(const Pose& pose, double wave, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> in(-2.0, 2.0);
    const Mat3 K = Mat3::NullaryExpr([&] { return in(random); }),
               P = Mat3::NullaryExpr([&] { return in(random); });
    nodes = model.tets.nodes;
    for (Eigen::Index n = 0; n < nodes.cols(); ++n) {
      const Vec3 x = nodes.col(n);
      nodes.col(n) = pose * Vec3(x + wave * (K * x + P.col(0)).array().sin().matrix());
    }
    set.update(nodes);
    mesh::evaluate(model.embedding, model.tets.tets, nodes, skin);
  }
};

struct Handed {
  std::set<int> a, b;
  bool a_twice = false;
};
inline Handed handed(std::span<const proxy::ContactRegion> regions) {
  Handed out;
  for (const auto& region : regions) {
    for (const int f : region.faces_a) out.a_twice |= !out.a.insert(f).second;
    out.b.insert(region.faces_b.begin(), region.faces_b.end());
  }
  return out;
}

inline bool holds(const std::set<int>& all, const std::set<int>& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

/// Winding number of a closed surface around a point: the solid angles of its faces (van Oosterom and
/// Strackee 1983) over 4 pi.
inline double winding(const Faces& faces, const Points& skin, const Vec3& p) {
  double angle = 0.0;
  for (Eigen::Index f = 0; f < faces.cols(); ++f) {
    const Vec3 a = skin.col(faces(0, f)) - p, b = skin.col(faces(1, f)) - p, c = skin.col(faces(2, f)) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * M_PI);
}

/// Returns which points are inside a closed surface, by brute force over all its faces.
inline std::vector<char> inside(const Points& points, const Faces& faces, const Points& skin) {
  const Vec3 low = skin.rowwise().minCoeff(), high = skin.rowwise().maxCoeff();
  std::vector<char> out(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index v = 0; v < points.cols(); ++v)
    out[static_cast<std::size_t>(v)] = (points.col(v).array() > low.array()).all() &&
                                       (points.col(v).array() < high.array()).all() &&
                                       winding(faces, skin, points.col(v)) > 0.5;
  return out;
}

/// Faces with a vertex for which the flag is set.
inline std::set<int> faces_at(const Faces& faces, const std::vector<char>& flag) {
  std::set<int> out;
  for (Eigen::Index f = 0; f < faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      if (flag[static_cast<std::size_t>(faces(k, f))]) out.insert(static_cast<int>(f));
  return out;
}

/// Faces of `one` with a vertex inside the other closed skin: the true contact patch.
inline std::set<int> true_patch(const Faces& faces, const Points& one, const Faces& other_faces,
                                const Points& other) {
  return faces_at(faces, inside(one, other_faces, other));
}

}  // namespace pruning
