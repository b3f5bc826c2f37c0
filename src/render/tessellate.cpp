#include "tessellate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

// A point-normal triangle is a cubic Bezier triangle. Its edge from P to Q with normals N and M has the inner
// control points (2 P + Q - ((Q - P).N) N) / 3 and (2 Q + P - ((P - Q).M) M) / 3: they lie in the tangent
// planes at P and Q. An edge depends on its own ends only, so neighbours share it where they share both
// normals; where they do not, it is a crease, and stays straight. The middle control point is E + (E - V) / 2
// with E the mean of the six inner ones of the edges and V that of the corners.
namespace palpate::render {
namespace {

using Vec3f = Eigen::Vector3f;

constexpr int kMost = 12;  // pieces per edge
constexpr std::size_t kMostCorners = 4'000'000;
constexpr float kTolerance = 0.1f;       // between a chord and its curve [pixels]
constexpr double kShare = 0.9;           // of the edges within the tolerance
constexpr float kSameNormal = 0.99999f;  // cosine

Vec3f position(const Corner& c) { return {c.position[0], c.position[1], c.position[2]}; }
Vec3f normal(const Corner& c) { return {c.normal[0], c.normal[1], c.normal[2]}; }

/// Normals at the ends of an edge in its first face, and whether all its faces have the same.
struct Edge {
  Vec3f low, high;
  bool smooth = true;
};

class Edges {
 public:
  Edges(const std::vector<Corner>& corners, const Faces& faces) {
    edges_.reserve(static_cast<std::size_t>(2 * faces.cols()));
    for (Eigen::Index f = 0; f < faces.cols(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int i = faces(k, f), j = faces((k + 1) % 3, f);
        Vec3f a = normal(corners[static_cast<std::size_t>(3 * f + k)]),
              b = normal(corners[static_cast<std::size_t>(3 * f + (k + 1) % 3)]);
        if (i > j) std::swap(a, b);
        const auto [found, first] = edges_.try_emplace(key(i, j), Edge{a, b});
        if (!first && (found->second.low.dot(a) < kSameNormal || found->second.high.dot(b) < kSameNormal))
          found->second.smooth = false;
      }
  }
  bool is_smooth(int i, int j) const { return edges_.at(key(i, j)).smooth; }

 private:
  static std::uint64_t key(int i, int j) {
    return static_cast<std::uint64_t>(std::min(i, j)) << 32 | static_cast<std::uint64_t>(std::max(i, j));
  }
  std::unordered_map<std::uint64_t, Edge> edges_;
};

/// Returns the number of pieces per edge: a chord of length L whose normals turn by an angle leaves its arc
/// by L angle / 8, and n pieces by that over n^2.
int pieces(const std::vector<Corner>& corners, const Viewport& viewport) {
  std::vector<float> errors;
  errors.reserve(corners.size());
  const auto pixels = [&](const Corner& c) -> Eigen::Vector2f {
    const Eigen::Vector4f clip = viewport.view_projection * position(c).homogeneous();
    const float w = std::max(std::abs(clip.w()), 1e-12f);
    return {0.5f * static_cast<float>(viewport.width) * clip.x() / w,
            0.5f * static_cast<float>(viewport.height) * clip.y() / w};
  };
  for (std::size_t f = 0; f + 2 < corners.size(); f += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner &a = corners[f + k], &b = corners[f + (k + 1) % 3];
      const float angle = std::acos(std::clamp(normal(a).dot(normal(b)), -1.0f, 1.0f));
      errors.push_back((pixels(b) - pixels(a)).norm() * angle / 8.0f);
    }
  if (errors.empty()) return 1;
  const auto at =
      errors.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(errors.size() - 1));
  std::nth_element(errors.begin(), at, errors.end());
  const auto needed = static_cast<int>(std::ceil(std::sqrt(*at / kTolerance)));
  const auto possible =
      static_cast<int>(std::sqrt(static_cast<double>(kMostCorners) / static_cast<double>(corners.size())));
  return std::clamp(needed, 1, std::max(1, std::min(kMost, possible)));
}

/// Curved patch over one triangle.
class Patch {
 public:
  Patch(const std::array<Corner, 3>& corners, const std::array<bool, 3>& smooth) : corners_(corners) {
    Vec3f sum = Vec3f::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner &p = corners[k], &q = corners[(k + 1) % 3];
      near_[k] = inner(p, q, smooth[k]);
      far_[k] = inner(q, p, smooth[k]);
      sum += near_[k] + far_[k];
    }
    const Vec3f edges = sum / 6.0f,
                middle = (position(corners[0]) + position(corners[1]) + position(corners[2])) / 3.0f;
    centre_ = edges + 0.5f * (edges - middle);
  }

  /// @param w  barycentric coordinates
  Corner at(const std::array<float, 3>& w) const {
    Vec3f p = 6.0f * w[0] * w[1] * w[2] * centre_, n = Vec3f::Zero();
    float value = 0.0f;
    for (std::size_t k = 0; k < 3; ++k) {
      const float a = w[k], b = w[(k + 1) % 3];
      p += a * a * a * position(corners_[k]) + 3.0f * a * a * b * near_[k] + 3.0f * a * b * b * far_[k];
      n += a * normal(corners_[k]);
      value += a * corners_[k].value;
    }
    n.normalize();
    return {{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, value};
  }

 private:
  /// Returns the control point of an edge next to p.
  static Vec3f inner(const Corner& p, const Corner& q, bool smooth) {
    const Vec3f along = position(q) - position(p);
    Vec3f out = position(p) + along / 3.0f;
    if (smooth) out -= along.dot(normal(p)) / 3.0f * normal(p);
    return out;
  }

  std::array<Corner, 3> corners_;
  std::array<Vec3f, 3> near_, far_;  ///< Control points of the edges, next to their first and second corner.
  Vec3f centre_;
};

}  // namespace

std::vector<Corner> tessellated(std::vector<Corner> corners, const Faces& faces, const Viewport& viewport) {
  const int n = pieces(corners, viewport);
  if (n == 1) return corners;
  const Edges edges(corners, faces);
  std::vector<Corner> out, row, next;
  out.reserve(corners.size() * static_cast<std::size_t>(n * n));
  for (Eigen::Index f = 0; f < faces.cols(); ++f) {
    const auto first = static_cast<std::size_t>(3 * f);
    std::array<bool, 3> smooth{};
    for (int k = 0; k < 3; ++k)
      smooth[static_cast<std::size_t>(k)] = edges.is_smooth(faces(k, f), faces((k + 1) % 3, f));
    const Patch patch({corners[first], corners[first + 1], corners[first + 2]}, smooth);
    const auto fill = [&](int i, std::vector<Corner>& points) {  // row i has n + 1 - i points
      points.clear();
      for (int j = 0; j <= n - i; ++j) {
        const auto pieces = static_cast<float>(n);
        points.push_back(patch.at({static_cast<float>(n - i - j) / pieces, static_cast<float>(j) / pieces,
                                   static_cast<float>(i) / pieces}));
      }
    };
    fill(0, row);
    for (int i = 0; i < n; ++i) {
      fill(i + 1, next);
      for (std::size_t j = 0; j + 1 < row.size(); ++j) {
        out.insert(out.end(), {row[j], row[j + 1], next[j]});
        if (j + 1 < next.size()) out.insert(out.end(), {row[j + 1], next[j + 1], next[j]});
      }
      row.swap(next);
    }
  }
  return out;
}

}  // namespace palpate::render
