#include "loop/contact_instant.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "proxy/hull_surface.h"

namespace palpate::loop {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

void deepen(double& depth, double other) {
  if (other > 0.0 && !(depth >= other)) depth = other;
}

/// Returns the depth at a point of either surface, interpolated bilinearly between the centres of the four
/// pixels around it that have both surfaces. NaN if no pixel does, or if the point is hidden from the camera
/// (on the far side of its body): then its height is outside the heights of these pixels by more than their
/// range plus a pixel.
double depth_at(const contact::RegionView& region, const Vec3& point) {
  const Vec3 uvw = region.axes.transpose() * (point - region.origin);
  const double x = (uvw.x() - region.u0) / region.pixel - 0.5, y = (uvw.y() - region.v0) / region.pixel - 0.5;
  if (!(x > -1.0 && y > -1.0 && x < region.width && y < region.height)) return kNone;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  double weights = 0.0, gap = 0.0;
  struct Heights {
    double low = HUGE_VAL, high = -HUGE_VAL;
    void add(double w) { low = std::min(low, w), high = std::max(high, w); }
    bool hold(double w, double pixel) const {
      const double room = pixel + (high - low);
      return w > low - room && w < high + room;
    }
  } a, b;
  for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
    const int c = column + i, r = row + j;
    if (c < 0 || r < 0 || c >= region.width || r >= region.height) continue;
    const auto at =
        static_cast<std::size_t>(r) * static_cast<std::size_t>(region.width) + static_cast<std::size_t>(c);
    const double g = region.gap[at], weight = (1.0 - std::abs(x - c)) * (1.0 - std::abs(y - r));
    if (std::isnan(g) || !(weight > 0.0)) continue;
    weights += weight;
    gap += weight * g;
    a.add(region.height_a[at]);
    b.add(region.height_a[at] - g);
  }
  if (weights == 0.0 || !(a.hold(uvw.z(), region.pixel) || b.hold(uvw.z(), region.pixel))) return kNone;
  return -gap / weights;
}

/// Vertices sorted by position, to find the vertex at which a sample lies.
class Places {
 public:
  explicit Places(const Points& points) : points_(points), order_(static_cast<std::size_t>(points.cols())) {
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(), [&](int i, int j) { return points(0, i) < points(0, j); });
    same_ = 1e-9 * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  }
  /// Returns the vertex at x; -1 if there is none.
  int at(const Vec3& x) const {
    auto i = std::lower_bound(order_.begin(), order_.end(), x.x() - same_,
                              [&](int v, double low) { return points_(0, v) < low; });
    for (; i != order_.end() && points_(0, *i) <= x.x() + same_; ++i)
      if ((points_.col(*i) - x).norm() <= same_) return *i;
    return -1;
  }

 private:
  const Points& points_;
  std::vector<int> order_;
  double same_;
};

}  // namespace

double deepest(const contact::RegionView& region) {
  double out = 0.0;
  for (const double gap : region.gap)
    if (gap < -out) out = -gap;
  return out;
}

ContactInstant contact_instant(const World& world) {
  ContactInstant out;
  std::vector<Points> surfaces;
  for (const Body& body : world.bodies) {
    surfaces.push_back(body.surface_points(world.positions(body)));
    out.depths.push_back(VecX::Constant(surfaces.back().cols(), kNone));
  }
  if (!world.contact) return out;
  const auto points = world.contact->points(world.state.view());
  for (const contact::ContactPoint& p : points) out.force_n += p.pressure * p.area;

  const std::vector<contact::PairReport> pairs = world.contact->pairs();
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    const ContactSpec& spec = world.description.contacts[pair];
    const contact::QueryView* view = pairs[pair].view;
    if (view) {
      out.regions.insert(out.regions.end(), view->regions.begin(), view->regions.end());
      for (const Points& hull : view->proxies_a) out.proxies.push_back({proxy::hull_surface(hull), true});
      for (const Points& hull : view->proxies_b) out.proxies.push_back({proxy::hull_surface(hull), false});
    }
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      if (world.bodies[i].name != spec.first && world.bodies[i].name != spec.second) continue;
      VecX& depths = out.depths[i];
      if (view && !view->regions.empty()) {
        for (const contact::RegionView& region : view->regions)
          for (Eigen::Index v = 0; v < depths.size(); ++v)
            deepen(depths[v], depth_at(region, surfaces[i].col(v)));
        continue;
      }
      const Places places(surfaces[i]);
      for (const contact::ContactPoint& p : points) {
        if (p.pair != static_cast<int>(pair) || !(p.own_gap < 0.0)) continue;
        for (const Vec3& x : {p.a, p.b})
          if (const int v = places.at(x); v >= 0) deepen(depths[v], -p.own_gap);
      }
    }
  }
  return out;
}

}  // namespace palpate::loop
