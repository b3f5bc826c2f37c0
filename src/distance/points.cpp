#include "palpate/distance/points.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::distance {
namespace {

/// Corners of the similar triangles, at i, j and k = n - i - j parts from the face's edges.  One inside the
/// face belongs to six triangles; one on an edge to three of this face, and to three beyond it where that
/// face is cut alike; a vertex to one per face.
class Corners {
 public:
  Corners(const Skin& skin, const std::vector<int>& cuts, std::vector<ContactPoint>& out)
      : skin_(skin), cuts_(cuts), out_(out) {}

  void add(int face, int i, int j) const {
    const int n = cuts_[static_cast<std::size_t>(face)], k = n - i - j;
    const int zeros = (i == 0) + (j == 0) + (k == 0);
    double area = 6.0 * share(face);
    if (zeros == 1) {
      const int beyond = skin_.across(i == 0 ? 0 : j == 0 ? 1 : 2, face);
      const bool alike = cuts_[static_cast<std::size_t>(beyond)] == n;
      if (alike && beyond < face) return;
      area = 3.0 * (share(face) + (alike ? share(beyond) : 0.0));
    } else if (zeros == 2) {
      const auto v = static_cast<std::size_t>(skin_.faces(i ? 0 : j ? 1 : 2, face));
      const auto begin = skin_.fan.begin() + skin_.fan_begin[v],
                 end = skin_.fan.begin() + skin_.fan_begin[v + 1];
      if (*begin != face) return;
      area = 0.0;
      for (auto f = begin; f != end; ++f) area += share(*f);
    }
    out_.push_back({face, Vec3(i, j, k) / n, area, 0.0});
  }

 private:
  /// A twelfth of one triangle.
  double share(int face) const {
    const int n = cuts_[static_cast<std::size_t>(face)];
    return skin_.area[face] / (12.0 * n * n);
  }

  const Skin& skin_;
  const std::vector<int>& cuts_;
  std::vector<ContactPoint>& out_;
};

}  // namespace

int cuts_of(const Skin& skin, int face, double spacing) {
  // An edge of the spacing itself, but for rounding, is one part.
  constexpr double kRounding = 1e-9;
  return static_cast<int>(
      std::clamp(std::ceil(skin.longest_edge[face] / spacing - kRounding), 1.0, double{kMostCuts}));
}

std::vector<ContactPoint> contact_points(const Skin& skin, double spacing) {
  if (!(spacing > 0.0)) fail("contact points: a spacing of {} m; it must be positive", spacing);
  std::vector<int> cuts;
  for (int face = 0; face < skin.face_count(); ++face) cuts.push_back(cuts_of(skin, face, spacing));
  std::vector<ContactPoint> out;
  const Corners corners(skin, cuts, out);
  for (int face = 0; face < skin.face_count(); ++face) {
    const int n = cuts[static_cast<std::size_t>(face)];
    const double area = skin.area[face] / (n * n);
    // A triangle that points as the face does has its centroid a third of a part from each side, one that
    // points the other way two thirds.
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j)
        for (int flipped = 0; flipped < (i + j + 1 < n ? 2 : 1); ++flipped) {
          const double third = (1.0 + flipped) / 3.0;
          const Vec3 at((i + third) / n, (j + third) / n, 0.0);
          out.push_back({face, Vec3(at[0], at[1], 1.0 - at[0] - at[1]), 0.75 * area, area});
        }
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) corners.add(face, i, j);
  }
  return out;
}

}  // namespace palpate::distance
