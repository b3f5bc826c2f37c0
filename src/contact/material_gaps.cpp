#include "contact/material_gaps.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "distance/linear_gap.h"

namespace palpate::contact {

MaterialGaps::MaterialGaps(const MaterialPoints& points, double curvature)
    : triangles_(points.triangles),
      triangle_area_(points.area),
      lowered_(curvature / 24.0 * points.edges2),
      hat_(points.at.size(), 0.0),
      fan_begin_(points.at.size() + 1, 0),
      place_(points.at.size(), -1),
      is_near_(static_cast<std::size_t>(points.triangles.cols()), 0) {
  for (const int p : triangles_.reshaped()) ++fan_begin_[static_cast<std::size_t>(p) + 1];
  std::partial_sum(fan_begin_.begin(), fan_begin_.end(), fan_begin_.begin());
  std::vector<int> next(fan_begin_.begin(), fan_begin_.end() - 1);
  fan_.resize(static_cast<std::size_t>(triangles_.size()));
  for (int t = 0; t < static_cast<int>(triangles_.cols()); ++t)
    for (const int p : triangles_.col(t)) {
      fan_[static_cast<std::size_t>(next[static_cast<std::size_t>(p)]++)] = t;
      hat_[static_cast<std::size_t>(p)] += triangle_area_[t] / 3.0;
    }
}

void MaterialGaps::start(const std::vector<char>& requested) {
  near_.clear();
  taken_.clear();
  const auto take = [&](int point) {
    int& place = place_[static_cast<std::size_t>(point)];
    if (place < 0) taken_.push_back(point);
    place = 0;
  };
  for (std::size_t p = 0; p < requested.size(); ++p) {
    if (!requested[p]) continue;
    for (int i = fan_begin_[p]; i < fan_begin_[p + 1]; ++i) {
      const int t = fan_[static_cast<std::size_t>(i)];
      char& is_near = is_near_[static_cast<std::size_t>(t)];
      if (is_near) continue;
      is_near = 1;
      near_.push_back({.number = t});
      for (const int corner : triangles_.col(t)) take(corner);
    }
  }
  std::sort(taken_.begin(), taken_.end());
  std::sort(near_.begin(), near_.end(),
            [](const Triangle& a, const Triangle& b) { return a.number < b.number; });
  for (std::size_t i = 0; i < taken_.size(); ++i)
    place_[static_cast<std::size_t>(taken_[i])] = static_cast<int>(i);
  for (Triangle& t : near_) {
    is_near_[static_cast<std::size_t>(t.number)] = 0;
    for (int k = 0; k < 3; ++k) t.corner[k] = place_[static_cast<std::size_t>(triangles_(k, t.number))];
  }
  for (const int point : taken_) place_[static_cast<std::size_t>(point)] = -1;
}

/// Calls visit(triangle, overlap at its corners) for each triangle with at least one overlapping corner.
template <class Visit>
void MaterialGaps::for_each_overlap(std::span<const Nearest> at, const Visit& visit) const {
  for (const Triangle& t : near_) {
    Vec3 overlap;
    for (int k = 0; k < 3; ++k)
      overlap[k] = lowered_[t.number] - at[static_cast<std::size_t>(t.corner[k])].gap;
    if ((overlap.array() > 0.0).any()) visit(t, overlap);
  }
}

void MaterialGaps::integrate(std::span<const Nearest> at) {
  overlap_.assign(taken_.size(), 0.0);
  area_.assign(taken_.size(), 0.0);
  square_.assign(taken_.size(), 0.0);
  for_each_overlap(at, [&](const Triangle& t, const Vec3& overlap) {
    const distance::HatIntegrals of = distance::integrate_hats(overlap);
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(t.corner[k]);
      overlap_[i] += triangle_area_[t.number] * of.overlap[k];
      area_[i] += triangle_area_[t.number] * of.area[k];
      square_[i] += triangle_area_[t.number] * of.overlap[k] * overlap[k];
    }
  });
  for (std::size_t i = 0; i < taken_.size(); ++i)
    if (overlap_[i] == 0.0) area_[i] = hat_[static_cast<std::size_t>(taken_[i])];
}

SumError::Query MaterialGaps::sum_error(std::span<const Vec3> x, std::span<const Nearest> at) const {
  SumError::Query out;
  for (const double overlap : overlap_) {
    out.sum += overlap;
    out.largest_term = std::max(out.largest_term, overlap);
  }
  for_each_overlap(at, [&](const Triangle& t, const Vec3& overlap) {
    Mat3 places, normals;
    for (int k = 0; k < 3; ++k) {
      places.col(k) = x[static_cast<std::size_t>(t.corner[k])];
      normals.col(k) = at[static_cast<std::size_t>(t.corner[k])].normal;
    }
    const distance::HatIntegrals of = distance::integrate_hats(overlap);
    const distance::Missed missed = distance::missed_by_linear(places, normals);
    out.error += triangle_area_[t.number] * std::abs(of.area.sum() * (missed.gap - lowered_[t.number]) +
                                                     of.overlap.sum() * missed.normal);
  });
  return out;
}

}  // namespace palpate::contact
