#include "contact/exact_lines.h"

#include <algorithm>
#include <cmath>

// Along a line, upwards, body a is entered where it faces down (A) and left where it is turned away (A'),
// body b is entered where it is turned away (B') and left where it faces up (B).  The crossings A and B,
// sorted by height, form runs A..A B..B A..A ...  A run of A with the run of B above it is an overlap, from
// its lowest A to its highest B, unless a is left and then b entered in between (A A' B' B): that is a tooth
// of a below another tooth of b, which do not touch there.  A run of B with the run of A above it is a gap.
// Of a height field along the normal there is one of either, and the image of the lowest A and the highest B
// is the same; teeth and overhangs have layers, each with a pair of its own.

namespace palpate::contact {
namespace {

/// Twice the area of p, q and the point, from the corner with the lower number, so that two triangles with a
/// common edge never both miss a point on it.
double side(const Vec3& p, const Vec3& q, bool swapped, double x, double y) {
  const Vec3 &from = swapped ? q : p, &to = swapped ? p : q;
  const double e = (to.x() - from.x()) * (y - from.y()) - (to.y() - from.y()) * (x - from.x());
  return swapped ? -e : e;
}

/// The pixel along one axis that holds x, within the image or just outside of it.
int bin_of(double x, double x0, double pixel, int count) {
  return static_cast<int>(std::clamp(std::floor((x - x0) / pixel), -1.0, static_cast<double>(count)));
}

}  // namespace

/// visit(line, u, v) for the lines through pixels of a rectangle.
struct ExactLines::Bins {
  std::span<const Eigen::Vector2d> points;
  const ExactLines& lines;
  int width;
  Eigen::Vector2d low, high;  ///< of the points

  bool may_meet(const AxisBox& box) const {
    return (box.low.head<2>().array() <= high.array()).all() &&
           (box.high.head<2>().array() >= low.array()).all();
  }
  template <class Visit>
  void operator()(int first_column, int last_column, int first_row, int last_row, Visit visit) const {
    first_column = std::max(first_column, lines.first_column_);
    last_column = std::min(last_column, lines.last_column_);
    first_row = std::max(first_row, lines.first_row_);
    last_row = std::min(last_row, lines.last_row_);
    for (int row = first_row; row <= last_row; ++row) {
      const auto start = static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
      // the bins of a row lie one behind the other
      const std::uint32_t end = lines.first_in_bin_[start + static_cast<std::size_t>(last_column) + 1];
      for (std::uint32_t i = lines.first_in_bin_[start + static_cast<std::size_t>(first_column)];
           first_column <= last_column && i < end; ++i) {
        const std::uint32_t line = lines.in_bins_[i];
        visit(line, points[line].x(), points[line].y());
      }
    }
  }
};

/// The lines through all middles.
struct ExactLines::Middles {
  const ContactCamera& camera;

  static bool may_meet(const AxisBox&) { return true; }
  template <class Visit>
  void operator()(int first_column, int last_column, int first_row, int last_row, Visit visit) const {
    for (int row = first_row; row <= last_row; ++row)
      for (int column = first_column; column <= last_column; ++column)
        visit(static_cast<std::uint32_t>(row * camera.width + column), camera.u(column), camera.v(row));
  }
};

template <class Lines>
void ExactLines::cut(const Patch& patch, const ContactCamera& camera, bool of_a, const Lines& lines) {
  for (std::size_t f = 0; f < patch.visible.size(); ++f)
    cut_face(patch, patch.visible[f], static_cast<std::uint32_t>(f), camera, of_a, lines);
  if (!patch.away) return;
  for (const int face : *patch.away) cut_face(patch, face, 0, camera, of_a, lines);
}

template <class Lines>
void ExactLines::cut_face(const Patch& patch, int face, std::uint32_t number, const ContactCamera& camera,
                          bool of_a, const Lines& lines) {
  const AxisBox box = box_of(patch, face);
  if (!lines.may_meet(box)) return;
  const auto corner = patch.faces->col(face);
  const Vec3 p[3] = {patch.uvw.col(corner[0]), patch.uvw.col(corner[1]), patch.uvw.col(corner[2])};
  const double area =
      (p[1].x() - p[0].x()) * (p[2].y() - p[0].y()) - (p[2].x() - p[0].x()) * (p[1].y() - p[0].y());
  if (area == 0.0) return;
  const int first_x = std::max(0, bin_of(box.low.x(), camera.u0, camera.pixel, camera.width)),
            last_x = std::min(camera.width - 1, bin_of(box.high.x(), camera.u0, camera.pixel, camera.width)),
            first_y = std::max(0, bin_of(box.low.y(), camera.v0, camera.pixel, camera.height)),
            last_y =
                std::min(camera.height - 1, bin_of(box.high.y(), camera.v0, camera.pixel, camera.height));
  const double turn = area > 0.0 ? 1.0 : -1.0;
  lines(first_x, last_x, first_y, last_y, [&](std::uint32_t line, double x, double y) {
    const double e0 = turn * side(p[1], p[2], corner[1] > corner[2], x, y),
                 e1 = turn * side(p[2], p[0], corner[2] > corner[0], x, y),
                 e2 = turn * side(p[0], p[1], corner[0] > corner[1], x, y);
    if (e0 < 0.0 || e1 < 0.0 || e2 < 0.0) return;
    const double w = (e0 * p[0].z() + e1 * p[1].z() + e2 * p[2].z()) / (e0 + e1 + e2);
    crossings_.push_back({line, number, w, of_a, (area > 0.0) == of_a});
  });
}

void ExactLines::through_pixels(const Patch& a, const Patch& b, const ContactCamera& camera,
                                double candidate_gap, std::vector<FacePair>& pairs) {
  pairs.clear();
  crossings_.clear();
  if (!camera.sees_something()) return;
  const Middles pixels{camera};
  cut(a, camera, true, pixels);
  cut(b, camera, false, pixels);
  pair_crossings(candidate_gap, pairs);
}

void ExactLines::through(std::span<const Eigen::Vector2d> points, const Patch& a, const Patch& b,
                         const ContactCamera& camera, double candidate_gap, std::vector<FacePair>& pairs) {
  pairs.clear();
  crossings_.clear();
  if (!camera.sees_something() || points.empty()) return;
  fill_bins(points, camera);
  Bins bins{points, *this, camera.width, points[0], points[0]};
  for (const Eigen::Vector2d& point : points) {
    bins.low = bins.low.cwiseMin(point);
    bins.high = bins.high.cwiseMax(point);
  }
  cut(a, camera, true, bins);
  cut(b, camera, false, bins);
  pair_crossings(candidate_gap, pairs);
}

void ExactLines::fill_bins(std::span<const Eigen::Vector2d> points, const ContactCamera& camera) {
  const auto size = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  first_in_bin_.assign(size + 1, 0);
  first_column_ = camera.width;
  first_row_ = camera.height;
  last_column_ = last_row_ = -1;
  const auto for_each = [&](auto visit) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const int column = bin_of(points[i].x(), camera.u0, camera.pixel, camera.width),
                row = bin_of(points[i].y(), camera.v0, camera.pixel, camera.height);
      if (column >= 0 && column < camera.width && row >= 0 && row < camera.height) visit(i, column, row);
    }
  };
  const auto bin = [&](int column, int row) { return static_cast<std::size_t>(row * camera.width + column); };
  for_each([&](std::size_t, int column, int row) {
    ++first_in_bin_[bin(column, row) + 1];
    first_column_ = std::min(first_column_, column);
    last_column_ = std::max(last_column_, column);
    first_row_ = std::min(first_row_, row);
    last_row_ = std::max(last_row_, row);
  });
  for (std::size_t i = 0; i < size; ++i) first_in_bin_[i + 1] += first_in_bin_[i];
  in_bins_.resize(first_in_bin_[size]);
  for_each([&](std::size_t i, int column, int row) {
    in_bins_[first_in_bin_[bin(column, row)]++] = static_cast<std::uint32_t>(i);
  });
  // each start has moved on to the next one's
  for (std::size_t i = size; i > 0; --i) first_in_bin_[i] = first_in_bin_[i - 1];
  first_in_bin_[0] = 0;
}

void ExactLines::pair_crossings(double candidate_gap, std::vector<FacePair>& pairs) {
  std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& p, const Crossing& q) {
    return p.line != q.line ? p.line < q.line : p.w < q.w;
  });
  for (std::size_t first = 0, last = 0; first < crossings_.size(); first = last) {
    while (last < crossings_.size() && crossings_[last].line == crossings_[first].line) ++last;
    pair_layers(first, last, candidate_gap, pairs);
  }
}

/// @param first, last  crossings of one line, by height
void ExactLines::pair_layers(std::size_t first, std::size_t last, double candidate_gap,
                             std::vector<FacePair>& pairs) {
  const Crossing *lowest_a = nullptr, *highest_b = nullptr, *last_b = nullptr;
  bool in_run_of_b = false, left_a = false;
  const auto end_overlap = [&] {
    if (lowest_a && highest_b) pairs.push_back({lowest_a->line, lowest_a->face, highest_b->face});
    lowest_a = highest_b = nullptr;
  };
  for (std::size_t i = first; i < last; ++i) {
    const Crossing& at = crossings_[i];
    if (at.of_a && at.away) {
      left_a = true;
    } else if (at.of_a) {
      left_a = false;
      if (in_run_of_b) {
        end_overlap();
        if (at.w - last_b->w < candidate_gap) pairs.push_back({at.line, at.face, last_b->face});
        in_run_of_b = false;
      }
      if (!lowest_a) lowest_a = &at;
    } else if (at.away) {
      if (left_a) end_overlap();
    } else {
      if (lowest_a) highest_b = &at;
      last_b = &at;
      in_run_of_b = true;
    }
  }
  end_overlap();
}

}  // namespace palpate::contact
