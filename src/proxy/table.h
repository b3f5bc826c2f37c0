#pragma once
#include <vector>

#include "palpate/core/types.h"
#include "proxy/lanes.h"

namespace palpate::proxy {

/// Points as columns of coordinates, set after set; each set is padded to whole lanes with its first point.
struct Table {
  std::vector<double> x, y, z;

  /// Appends a set of points, padded with its first.
  void append(const Points& points) {
    for (int i = 0; i < padded(static_cast<int>(points.cols())); ++i) {
      const Vec3 p = points.col(i < points.cols() ? i : 0);
      x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
    }
  }
  /// Appends a set of points, padded with zeros.
  void append_padded_with_zero(const Points& points) {
    for (int i = 0; i < padded(static_cast<int>(points.cols())); ++i) {
      const Vec3 p = i < points.cols() ? Vec3(points.col(i)) : Vec3(Vec3::Zero());
      x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
    }
  }
  void resize(int count) {
    for (auto* column : {&x, &y, &z}) column->resize(static_cast<std::size_t>(count));
  }
  Vec3 point(int i) const {
    const auto at = static_cast<std::size_t>(i);
    return {x[at], y[at], z[at]};
  }
  /// Returns the columns from entry `first` on.
  Columns read(int first) const { return {x.data() + first, y.data() + first, z.data() + first}; }
  MutableColumns write(int first) { return {x.data() + first, y.data() + first, z.data() + first}; }
  int size() const { return static_cast<int>(x.size()); }
};

}  // namespace palpate::proxy
