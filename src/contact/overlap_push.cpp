// A pixel of area dA shows (-grad w, 1) dA of a skin of height w, and pushes d dA of its volume.  The part
// across the normal is
//     Q = -int d grad w dA,      w = (w_a + w_b)/2, for both skins say the same (region_planes.cpp).
// The slopes of the triangles at the pixels are the wrong way to it: a wall of height H has a slope that is
// as large as its image is narrow, and whether a pixel meets it is chance.  The differences of w between
// neighbouring pixels miss no wall: with d and w linear from one to the other, a distance h apart,
//     Q_x = -sum over edges of h (d_i + d_j)/2 (w_j - w_i),
// where both press; where the depth ends between them, d_j = -g < 0, the part t = d_i / (d_i + g) that
// presses has the mean depth d_i / 2 and counts -h t (d_i / 2) (w_j - w_i).  Where nothing is seen next to a
// pixel, or only beyond the candidate gap c, there is no difference; towards that an edge counts by 1 - g /
// c, so that it does not come or go at once.
//
// Of few pixels the edges hold another share of the volume V along one axis than the pixels do, W_x = sum of
// h^2 times the same depths, which only tends to V.  So Q_x V / W_x is taken: of plane skins it is exact,
// however few pixels see them.
//
// At first touch d is rounding and pixels.  Skins that are taken to be a little closer than they are push as
// the patch does that comes to touch; where the overlap is deeper than that, it makes no difference.
#include "contact/overlap_push.h"

#include <algorithm>

namespace palpate::contact {

Vec3 PixelPush::integral() const {
  Vec3 out = sum;
  for (int axis = 0; axis < 2; ++axis)
    out[axis] = read_from[axis] > 0.0 ? sum[axis] * sum.z() / read_from[axis] : 0.0;
  return out;
}

std::span<const PixelPush> OverlapPush::find(std::span<const Hit> hits, const ContactCamera& camera,
                                             double candidate_gap, double closer) {
  candidate_gap_ = candidate_gap - closer;
  closer_ = closer;
  const int width = camera.width, height = camera.height;
  deepest_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), -1);
  push_.assign(hits.size(), {});
  for (std::size_t i = 0; i < hits.size(); ++i) {
    int& at = deepest_[hits[i].pixel];
    if (at < 0 || hits[i].at.gap() < hits[static_cast<std::size_t>(at)].at.gap()) at = static_cast<int>(i);
    push_[i].sum.z() = std::max(0.0, closer - hits[i].at.gap()) * hits[i].area;
  }
  for (std::size_t p = 0; p < deepest_.size(); ++p) {
    if (deepest_[p] < 0) continue;
    const int column = static_cast<int>(p) % width, row = static_cast<int>(p) / width;
    if (column + 1 < width && deepest_[p + 1] >= 0)
      add_edge(hits, deepest_[p], deepest_[p + 1], 0, camera.pixel);
    if (const std::size_t above = p + static_cast<std::size_t>(width);
        row + 1 < height && deepest_[above] >= 0)
      add_edge(hits, deepest_[p], deepest_[above], 1, camera.pixel);
  }
  return push_;
}

void OverlapPush::add_edge(std::span<const Hit> hits, int i, int j, int axis, double pixel) {
  const auto one = static_cast<std::size_t>(i), other = static_cast<std::size_t>(j);
  const Facing &p = hits[one].at, &q = hits[other].at;
  const double d_p = closer_ - p.gap(), d_q = closer_ - q.gap();
  if (d_p <= 0.0 && d_q <= 0.0) return;
  const double rise = 0.5 * (q.w_a + q.w_b - p.w_a - p.w_b);
  if (d_p > 0.0 && d_q > 0.0) {
    add(one, axis, 0.5 * d_p, rise, pixel);
    add(other, axis, 0.5 * d_q, rise, pixel);
    return;
  }
  const double depth = std::max(d_p, d_q), gap = -std::min(d_p, d_q);
  const double presses = depth / (depth + gap) * 0.5 * depth * std::max(0.0, 1.0 - gap / candidate_gap_);
  add(d_p > 0.0 ? one : other, axis, presses, rise, pixel);
}

void OverlapPush::add(std::size_t hit, int axis, double depth, double rise, double pixel) {
  push_[hit].sum[axis] -= pixel * depth * rise;
  push_[hit].read_from[axis] += pixel * pixel * depth;
}

}  // namespace palpate::contact
