#include "a_reference_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/error.h"

namespace palpate::validation {

SampleAt sample_at(const contact::ContactSample& sample, const Points& nodes) {
  PALPATE_CHECK(sample.b.frame >= 0, "the second side of a sample is rigid here, got frame {}",
                sample.b.frame);
  SampleAt out{sample.a.offset, sample.b.offset};  // The frame coincides with the world frame.
  for (int k = 0; k < sample.a.count; ++k)
    out.a +=
        sample.a.weight[static_cast<std::size_t>(k)] * nodes.col(sample.a.node[static_cast<std::size_t>(k)]);
  return out;
}

PixelGrid grid_of(const std::vector<contact::ContactSample>& samples, const Points& nodes, int margin) {
  PALPATE_CHECK(!samples.empty(), "no samples, no grid");
  PixelGrid grid;
  const Vec3 n = samples.front().normal;
  grid.axes.col(2) = n;
  // Same choice of axes as in the library.
  grid.axes.col(0) = Vec3(std::abs(n.x()) < 0.8 ? Vec3::UnitX() : Vec3::UnitY()).cross(n).normalized();
  grid.axes.col(1) = n.cross(grid.axes.col(0));
  grid.pixel = std::sqrt(samples.front().area);
  grid.origin = sample_at(samples.front(), nodes).b;
  Cell low{0, 0}, high{0, 0};
  for (const auto& s : samples) {
    const Cell cell = cell_of(grid, sample_at(s, nodes).b);
    low = {std::min(low.column, cell.column), std::min(low.row, cell.row)};
    high = {std::max(high.column, cell.column), std::max(high.row, cell.row)};
  }
  grid.origin = grid.middle(low.column - margin, low.row - margin);
  grid.width = high.column - low.column + 1 + 2 * margin;
  grid.height = high.row - low.row + 1 + 2 * margin;
  return grid;
}

Cell cell_of(const PixelGrid& grid, const Vec3& point) {
  const Vec3 at = grid.axes.transpose() * (point - grid.origin) / grid.pixel;
  return {static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y()))};
}

namespace {

/// Returns the height along n of the triangles that face `side`, per pixel: the lowest for side -1, the
/// highest for side 1; NaN where there is none.
std::vector<double> heights(const PixelGrid& grid, const TriMesh& mesh, double side) {
  std::vector<double> out(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height),
                          std::nan(""));
  const Points x = grid.axes.transpose() * (mesh.vertices.colwise() - grid.origin) / grid.pixel;
  for (const auto& face : mesh.faces.colwise()) {
    const Vec3 p = x.col(face[0]), q = x.col(face[1]), r = x.col(face[2]);
    const auto cross = [](const Vec3& o, const Vec3& s, double u, double v) {
      return (s.x() - o.x()) * (v - o.y()) - (s.y() - o.y()) * (u - o.x());
    };
    const double area = cross(p, q, r.x(), r.y());
    if (!(side * area > 0.0)) continue;
    const int first_u = std::max(0, static_cast<int>(std::ceil(std::min({p.x(), q.x(), r.x()})))),
              last_u =
                  std::min(grid.width - 1, static_cast<int>(std::floor(std::max({p.x(), q.x(), r.x()})))),
              first_v = std::max(0, static_cast<int>(std::ceil(std::min({p.y(), q.y(), r.y()})))),
              last_v =
                  std::min(grid.height - 1, static_cast<int>(std::floor(std::max({p.y(), q.y(), r.y()}))));
    for (int v = first_v; v <= last_v; ++v)
      for (int u = first_u; u <= last_u; ++u) {
        const double wp = cross(q, r, u, v) / area, wq = cross(r, p, u, v) / area,
                     wr = cross(p, q, u, v) / area;
        if (std::min({wp, wq, wr}) < -1e-12) continue;
        const double w = grid.pixel * (wp * p.z() + wq * q.z() + wr * r.z());
        double& to = out[static_cast<std::size_t>(v * grid.width + u)];
        if (std::isnan(to) || side * (w - to) > 0.0) to = w;
      }
  }
  return out;
}

}  // namespace

std::vector<DepthPixel> cast(const PixelGrid& grid, const TriMesh& a, const TriMesh& b) {
  const std::vector<double> lowest = heights(grid, a, -1.0), highest = heights(grid, b, 1.0);
  std::vector<DepthPixel> out(lowest.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].covered = !std::isnan(lowest[i]) && !std::isnan(highest[i]);
    if (out[i].covered) out[i].gap = lowest[i] - highest[i];
  }
  return out;
}

FieldError compare_fields(const std::vector<contact::ContactSample>& samples, const TriMesh& a,
                          const TriMesh& b) {
  FieldError out;
  const PixelGrid grid = grid_of(samples, a.vertices, 3);
  const std::vector<DepthPixel> truth = cast(grid, a, b);
  const auto index = [&](int column, int row) { return static_cast<std::size_t>(row * grid.width + column); };
  const auto overlaps = [&](int column, int row) {
    const DepthPixel& pixel = truth[index(column, row)];
    return pixel.covered && pixel.gap < 0.0;
  };
  // Returns whether all neighbours of a pixel have the given overlap state, so that the pixel is more than a
  // pixel away from the silhouette.
  const auto around = [&](int column, int row, bool requested) {
    for (int v = std::max(0, row - 1); v <= std::min(grid.height - 1, row + 1); ++v)
      for (int u = std::max(0, column - 1); u <= std::min(grid.width - 1, column + 1); ++u)
        if (overlaps(u, v) != requested) return false;
    return true;
  };
  std::vector<char> seen(truth.size(), 0);
  for (const auto& s : samples) {
    if (!(s.gap < 0.0)) continue;
    const Cell cell = cell_of(grid, sample_at(s, a.vertices).b);
    seen[index(cell.column, cell.row)] = 1;
    if (overlaps(cell.column, cell.row)) {
      ++out.compared;
      // At the silhouette the image may select another triangle than the exact method.
      if (around(cell.column, cell.row, true))
        out.inside = std::max(out.inside, std::abs(s.gap - truth[index(cell.column, cell.row)].gap));
    } else if (around(cell.column, cell.row, false)) {
      ++out.extra;
    }
  }
  for (int row = 0; row < grid.height; ++row)
    for (int column = 0; column < grid.width; ++column)
      if (!seen[index(column, row)] && overlaps(column, row) && around(column, row, true)) ++out.missed;
  return out;
}

}  // namespace palpate::validation
