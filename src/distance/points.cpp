#include "palpate/distance/points.h"

#include <algorithm>

#include "palpate/core/error.h"

namespace palpate::distance {
namespace {

/// Corners of the similar triangles, at i, j and k = n - i - j parts from the face's edges.  One inside the
/// face belongs to six triangles, one on an edge to three of this face and three beyond it, a vertex to one
/// per face.
class Corners {
 public:
  Corners(const Skin& skin, int cuts, std::vector<ContactPoint>& out)
      : skin_(skin), cuts_(cuts), share_(1.0 / (12.0 * cuts * cuts)), out_(out) {}

  void add(int face, int i, int j) const {
    const int k = cuts_ - i - j;
    const int zeros = (i == 0) + (j == 0) + (k == 0);
    double area = 6.0 * skin_.area[face];
    if (zeros == 1) {
      const int beyond = skin_.across(i == 0 ? 0 : j == 0 ? 1 : 2, face);
      if (beyond < face) return;
      area = 3.0 * (skin_.area[face] + skin_.area[beyond]);
    } else if (zeros == 2) {
      const auto v = static_cast<std::size_t>(skin_.faces(i ? 0 : j ? 1 : 2, face));
      const auto begin = skin_.fan.begin() + skin_.fan_begin[v],
                 end = skin_.fan.begin() + skin_.fan_begin[v + 1];
      if (*begin != face) return;
      area = 0.0;
      for (auto f = begin; f != end; ++f) area += skin_.area[*f];
    }
    out_.push_back({face, Vec3(i, j, k) / cuts_, share_ * area, 0.0});
  }

 private:
  const Skin& skin_;
  int cuts_;
  double share_;
  std::vector<ContactPoint>& out_;
};

}  // namespace

std::vector<ContactPoint> contact_points(const Skin& skin, int cuts) {
  if (cuts < 1 || cuts > kMostCuts) fail("contact points: {} parts per edge; use 1 to {}", cuts, kMostCuts);
  std::vector<ContactPoint> out;
  const Corners corners(skin, cuts, out);
  for (int face = 0; face < skin.face_count(); ++face) {
    const double area = skin.area[face] / (cuts * cuts);
    // A triangle that points as the face does has its centroid a third of a part from each side, one that
    // points the other way two thirds.
    for (int i = 0; i < cuts; ++i)
      for (int j = 0; i + j < cuts; ++j)
        for (int flipped = 0; flipped < (i + j + 1 < cuts ? 2 : 1); ++flipped) {
          const double third = (1.0 + flipped) / 3.0;
          const Vec3 at((i + third) / cuts, (j + third) / cuts, 0.0);
          out.push_back({face, Vec3(at[0], at[1], 1.0 - at[0] - at[1]), 0.75 * area, area});
        }
    for (int i = 0; i <= cuts; ++i)
      for (int j = 0; i + j <= cuts; ++j) corners.add(face, i, j);
  }
  return out;
}

}  // namespace palpate::distance
