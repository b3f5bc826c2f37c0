#include "gear.h"

#include <cmath>
#include <numbers>

#include "palpate/core/error.h"
#include "plane.h"

// The surface is a chain of loops around the axis: up the teeth, in over the top, down the bore, out over the
// bottom.  Two loops with equal numbers of points are joined by a band of quadrilaterals; two coplanar loops,
// or loops with different numbers, by a plane ring filled with triangles.  With counter-clockwise loops along
// the chain, the outside is always on the same side.
namespace palpate::shapes {
namespace {

struct Loop {
  std::vector<Point2> points;
  double z = 0.0;
};

/// Loops of the gear's surface and numbers of rows between them.
struct Plan {
  std::vector<Loop> top;  ///< from the upper edge of the teeth in to the upper edge of the bore
  int teeth_rows = 1, bore_rows = 1;
};

std::vector<Point2> ring(double radius, int count) {
  std::vector<Point2> out;
  for (int i = 0; i < count; ++i)
    out.emplace_back(radius * std::cos(2.0 * std::numbers::pi * i / count),
                     radius * std::sin(2.0 * std::numbers::pi * i / count));
  return out;
}

int pieces(double length, double spacing) {
  return std::max(1, static_cast<int>(std::lround(length / spacing)));
}

/// Appends a cone from one radius to another, in rows, without its first loop.
void add_cone(std::vector<Loop>& chain, double r0, double z0, double r1, double z1, int count,
              double spacing) {
  const int rows = pieces(std::hypot(r1 - r0, z1 - z0), spacing);
  for (int i = 1; i <= rows; ++i)
    chain.push_back({ring(r0 + (r1 - r0) * i / rows, count), z0 + (z1 - z0) * i / rows});
}

constexpr double kChamfer = 0.0005, kBoreChamfer = 0.0008;  // [m]
// Dimensions of the web between rim and hub [m].
constexpr double kRecess = 0.0015, kRim = 0.037, kWebOuter = 0.0355, kWebInner = 0.0215, kHub = 0.020;

/// Returns the outline offset inwards by a chamfer, point by point.  At a tip's corner, which meets both
/// sides' offsets, the point also slides along each side; its neighbours share the slide, decreasing over
/// half the tip, so that no point passes another.
std::vector<Point2> chamfered(const GearProfile& profile, double chamfer) {
  const int n = static_cast<int>(profile.points.size());
  const auto at = [&](int i) { return static_cast<std::size_t>((i % n + n) % n); };
  std::vector<Point2> out;
  for (std::size_t i = 0; i < profile.points.size(); ++i)
    out.push_back(profile.points[i] - chamfer * profile.normals[i]);
  // across a tip, from corner to corner
  const double reach =
      0.45 * (profile.points[at(profile.corners[1])] - profile.points[at(profile.corners[2])]).norm();
  for (const int corner : profile.corners)
    for (const int side : {-1, 1}) {
      const Point2 first = (profile.points[at(corner + side)] - profile.points[at(corner)]).normalized();
      const double slide = -chamfer * profile.normals[at(corner)].dot(first);
      double along = 0.0;
      for (int i = corner + side;; i += side) {
        const Point2 step = profile.points[at(i)] - profile.points[at(i - side)];
        along += step.norm();
        if (along >= reach) break;
        out[at(i)] += slide * (1.0 - along / reach) * step.normalized();
      }
    }
  return out;
}

Plan plan_of(const GearSize& size, double spacing, bool fine) {
  const GearProfile profile = gear_profile(size, spacing);
  const double h = 0.5 * size.width;
  Plan plan;
  plan.teeth_rows = pieces(size.width - (fine ? 2.0 * kChamfer : 0.0), spacing);
  plan.bore_rows = pieces(size.width - (fine ? 2.0 * kBoreChamfer : 0.0), spacing);
  if (!fine) {
    plan.top = {{profile.points, h},
                {ring(size.bore, pieces(2.0 * std::numbers::pi * size.bore, spacing)), h}};
    return plan;
  }
  plan.top.push_back({profile.points, h - kChamfer});
  plan.top.push_back({chamfered(profile, kChamfer), h});
  const int at_rim = pieces(2.0 * std::numbers::pi * kRim, spacing),
            at_hub = pieces(2.0 * std::numbers::pi * kHub, spacing),
            at_bore = pieces(2.0 * std::numbers::pi * size.bore, spacing);
  plan.top.push_back({ring(kRim, at_rim), h});
  add_cone(plan.top, kRim, h, kWebOuter, h - kRecess, at_rim, spacing);
  plan.top.push_back({ring(kWebInner, at_hub), h - kRecess});
  add_cone(plan.top, kWebInner, h - kRecess, kHub, h, at_hub, spacing);
  plan.top.push_back({ring(size.bore + kBoreChamfer, at_bore), h});
  add_cone(plan.top, size.bore + kBoreChamfer, h, size.bore, h - kBoreChamfer, at_bore, spacing);
  return plan;
}

bool is_plane_ring(const Loop& a, const Loop& b) {
  return a.points.size() != b.points.size() || (a.z == b.z);
}

/// Returns the number of interior vertices of each plane ring of the top, for triangles of edge `spacing`.
std::vector<int> fillings(const Plan& plan, double spacing) {
  std::vector<int> out;
  for (std::size_t i = 0; i + 1 < plan.top.size(); ++i)
    if (is_plane_ring(plan.top[i], plan.top[i + 1]))
      out.push_back(vertices_between(plan.top[i].points, plan.top[i + 1].points, spacing));
  return out;
}

int total(const Plan& plan, const std::vector<int>& filling) {
  std::size_t n = 0;
  for (const Loop& loop : plan.top) n += 2 * loop.points.size();
  n += static_cast<std::size_t>(plan.teeth_rows - 1) * plan.top.front().points.size() +
       static_cast<std::size_t>(plan.bore_rows - 1) * plan.top.back().points.size();
  for (const int inside : filling) n += 2 * static_cast<std::size_t>(inside);
  return static_cast<int>(n);
}

/// Assembles the surface.
class Assembly {
 public:
  int add(const Loop& loop) {
    const int first = static_cast<int>(points_.size());
    for (const Point2& p : loop.points) points_.emplace_back(p.x(), p.y(), loop.z);
    return first;
  }
  /// Adds quadrilaterals from the loop that starts at a to the loop at b, cut along the shorter diagonal.
  void band(int a, int b, int count) {
    for (int i = 0; i < count; ++i) {
      const int j = (i + 1) % count, p = a + i, q = a + j, r = b + j, s = b + i;
      const double one = (at(p) - at(r)).squaredNorm(), other = (at(q) - at(s)).squaredNorm();
      if (std::abs(one - other) < 1e-9 * (one + other) ? i % 2 == 0 : one < other)
        triangle(p, q, r), triangle(p, r, s);
      else
        triangle(p, q, s), triangle(q, r, s);
    }
  }
  /// Adds a plane ring.
  /// @param a, b    first vertices of the outer loop and of the hole
  /// @param facing  +1 up, -1 down
  void plane(const TriMesh& mesh, int a, int outer, int b, int hole, double z, int facing) {
    const int first = static_cast<int>(points_.size()) - outer - hole;
    for (Eigen::Index v = outer + hole; v < mesh.vertices.cols(); ++v)
      points_.emplace_back(mesh.vertices(0, v), mesh.vertices(1, v), z);
    const auto number = [&](int v) {
      return v < outer ? a + v : v < outer + hole ? b + v - outer : first + v;
    };
    for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
      const int p = number(mesh.faces(0, f)), q = number(mesh.faces(1, f)), r = number(mesh.faces(2, f));
      facing > 0 ? triangle(p, q, r) : triangle(p, r, q);
    }
  }
  const Vec3& at(int v) const { return points_[static_cast<std::size_t>(v)]; }
  TriMesh take() const {
    TriMesh mesh;
    mesh.vertices.resize(3, static_cast<Eigen::Index>(points_.size()));
    for (std::size_t v = 0; v < points_.size(); ++v)
      mesh.vertices.col(static_cast<Eigen::Index>(v)) = points_[v];
    mesh.faces.resize(3, static_cast<Eigen::Index>(faces_.size()));
    for (std::size_t f = 0; f < faces_.size(); ++f) mesh.faces.col(static_cast<Eigen::Index>(f)) = faces_[f];
    return mesh;
  }

 private:
  void triangle(int a, int b, int c) { faces_.emplace_back(a, b, c); }
  std::vector<Vec3> points_;
  std::vector<Eigen::Vector3i> faces_;
};

/// Builds the surface and, if requested, its creases (for the base: the outline and the bore above and below,
/// and the tips' corners in between).
TriMesh build(const GearSize& size, int vertices, bool fine, std::vector<std::vector<Vec3>>* creases) {
  double low = 1e-5, high = 0.02;
  for (int i = 0; i < 40; ++i) {  // the number of vertices falls as the spacing grows
    const double middle = 0.5 * (low + high);
    const Plan trial = plan_of(size, middle, fine);
    (total(trial, fillings(trial, middle)) > vertices ? low : high) = middle;
  }
  const Plan plan = plan_of(size, high, fine);
  std::vector<int> filling = fillings(plan, high);
  const std::size_t largest =
      static_cast<std::size_t>(std::max_element(filling.begin(), filling.end()) - filling.begin());
  filling[largest] = std::max(0, filling[largest] + (vertices - total(plan, filling)) / 2);

  Assembly out;
  const std::size_t n = plan.top.size();
  std::vector<int> top(n), bottom(n);
  for (std::size_t i = 0; i < n; ++i) {
    top[i] = out.add(plan.top[i]);
    bottom[i] = out.add({plan.top[i].points, -plan.top[i].z});
  }
  std::size_t planes = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const Loop &a = plan.top[i], &b = plan.top[i + 1];
    const int count = static_cast<int>(a.points.size()), inner = static_cast<int>(b.points.size());
    if (is_plane_ring(a, b)) {
      const TriMesh mesh = between(a.points, b.points, filling[planes++]);
      out.plane(mesh, top[i], count, top[i + 1], inner, a.z, 1);
      out.plane(mesh, bottom[i], count, bottom[i + 1], inner, -a.z, -1);
    } else {
      out.band(top[i], top[i + 1], count);
      out.band(bottom[i + 1], bottom[i], count);
    }
  }
  // Adds the wall between the top and the bottom copy of a loop.
  const auto wall = [&](std::size_t i, int rows, bool up) {
    const Loop& loop = plan.top[i];
    std::vector<int> starts = {bottom[i]};
    for (int k = 1; k < rows; ++k) starts.push_back(out.add({loop.points, loop.z * (2.0 * k / rows - 1.0)}));
    starts.push_back(top[i]);
    const int count = static_cast<int>(loop.points.size());
    for (int k = 0; k < rows; ++k)
      up ? out.band(starts[static_cast<std::size_t>(k)], starts[static_cast<std::size_t>(k) + 1], count)
         : out.band(starts[static_cast<std::size_t>(k) + 1], starts[static_cast<std::size_t>(k)], count);
    return starts;
  };
  const std::vector<int> rows = wall(0, plan.teeth_rows, true);
  wall(n - 1, plan.bore_rows, false);
  if (creases) {
    for (const std::vector<int>& starts : {top, bottom})
      for (const std::size_t i : {std::size_t{0}, n - 1}) {
        const int count = static_cast<int>(plan.top[i].points.size());
        std::vector<Vec3> line;
        for (int k = 0; k <= count; ++k) line.push_back(out.at(starts[i] + k % count));
        creases->push_back(line);
      }
    for (const int corner : gear_profile(size, high).corners) {
      std::vector<Vec3> line;
      for (const int start : rows) line.push_back(out.at(start + corner));
      creases->push_back(line);
    }
  }
  return out.take();
}

}  // namespace

Shape make_gear(const Resolution& resolution) {
  const GearSize size;
  Shape shape;
  shape.name = "gear";
  shape.tetrahedra = 20000;  // the creases alone require 19,000
  shape.base = build(size, resolution.base_vertices, false, &shape.creases);
  shape.skin = build(size, resolution.skin_vertices, true, nullptr);
  return shape;
}

}  // namespace palpate::shapes
