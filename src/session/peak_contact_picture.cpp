#include "session/peak_contact_picture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>

#include "core/missing_outputs.h"
#include "core/time_text.h"
#include "palpate/core/error.h"
#include "render/field.h"
#include "render/marks.h"
#include "render/panels.h"
#include "session/snapshot_scene.h"

namespace palpate::session {
namespace {

constexpr render::Rgb kHullA = {0.16f, 0.44f, 0.70f}, kHullB = {0.85f, 0.45f, 0.13f},
                      kEdge = {0.18f, 0.20f, 0.24f}, kVertex = {0.00f, 0.62f, 0.75f},
                      kPlain = {0.80f, 0.79f, 0.77f};
constexpr int kPanel = 800;      ///< Edge of a panel [pixels]
constexpr double kSharp = 25.0;  ///< Smallest dihedral angle of the hull edges that are drawn: the edges of
                                 ///< all facets would hide one another [deg]

/// Patch of a surface in contact: its colliding vertices and its direction.
struct Patch {
  std::size_t body = 0;          ///< Index of the body
  Points vertices;               ///< Colliding vertices that face outward [m]
  Vec3 outward = Vec3::UnitZ();  ///< Mean outward normal, a unit vector
  double edge = 0.0;             ///< Mean edge of the triangles of all colliding vertices of the body [m]
};

/// Returns the patch of each colliding vertex, -1 for others. A patch is a set of vertices connected by
/// triangles whose corners all collide, numbered by its lowest vertex.
std::vector<int> patches(const Faces& faces, const VecX& depths) {
  std::vector<int> patch(static_cast<std::size_t>(depths.size()), -1);
  for (int v = 0; v < depths.size(); ++v)
    if (depths[v] > 0.0) patch[static_cast<std::size_t>(v)] = v;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto f : faces.colwise()) {
      int low = std::numeric_limits<int>::max();
      for (const int v : f) low = std::min(low, patch[static_cast<std::size_t>(v)]);
      if (low < 0) continue;  // one of the corners does not collide
      for (const int v : f)
        if (patch[static_cast<std::size_t>(v)] != low)
          patch[static_cast<std::size_t>(v)] = low, changed = true;
    }
  }
  return patch;
}

/// Returns the patch with the largest overlap of all bodies, with all colliding vertices of its body that
/// face in its direction.
Patch largest_patch(const render::Scene& scene, const loop::ContactInstant& contact) {
  Patch out;
  double largest = 0.0;
  for (std::size_t i = 0; i < contact.depths.size(); ++i) {
    const render::Surface& surface = scene.surfaces[i];
    const VecX& depths = contact.depths[i];
    const std::vector<int> patch = patches(surface.faces, depths);
    Points normals = Points::Zero(3, depths.size());  // times area
    std::map<int, std::pair<double, Vec3>> sums;      // per patch: depth times area, normal times area
    double edges = 0.0;
    int count = 0;
    for (const auto f : surface.faces.colwise()) {
      const Vec3 e = surface.points.col(f[1]) - surface.points.col(f[0]),
                 g = surface.points.col(f[2]) - surface.points.col(f[0]), area = 0.5 * e.cross(g);
      for (const int v : f) {
        if (!(depths[v] > 0.0)) continue;
        normals.col(v) += area / 3.0;
        auto& [volume, normal] =
            sums.try_emplace(patch[static_cast<std::size_t>(v)], 0.0, Vec3::Zero()).first->second;
        volume += depths[v] * area.norm() / 3.0;
        normal += area / 3.0;
        edges += e.norm();
        ++count;
      }
    }
    for (const auto& [name, sum] : sums) {
      if (!(sum.first > largest) || !(sum.second.norm() > 0.0)) continue;
      largest = sum.first;
      out.body = i;
      out.outward = sum.second.normalized();
      out.edge = edges / count;
      std::vector<int> shown;
      for (int v = 0; v < depths.size(); ++v)
        if (depths[v] > 0.0 && normals.col(v).dot(out.outward) > 0.0) shown.push_back(v);
      out.vertices = surface.points(Eigen::all, shown);
    }
  }
  return out;
}

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// Returns a view from the side that `outward` points to, turned by `aside_deg` and slightly from above.
render::View from_side(const Vec3& outward, double aside_deg) {
  render::View view;
  view.azimuth_deg = degrees(std::atan2(outward.y(), outward.x())) + aside_deg;
  view.elevation_deg = std::clamp(degrees(std::asin(std::clamp(outward.z(), -1.0, 1.0))) + 14.0, -80.0, 80.0);
  return view;
}

/// Returns a view across the contact normal; of the two candidates, the one closer to the default view.
render::View across(const Vec3& normal) {
  render::View view;
  view.elevation_deg = 16.0;
  if (normal.head<2>().norm() < 0.3) return view;
  const double along = degrees(std::atan2(normal.y(), normal.x()));
  const auto off = [&](double azimuth) {
    return std::abs(std::remainder(azimuth - view.azimuth_deg, 360.0));
  };
  const double left = along + 90.0, right = along - 90.0, usual = off(left) < off(right) ? left : right;
  view.azimuth_deg = usual;
  return view;
}

/// Returns points that make a camera frame the given points with a margin: the points scaled by `times` about
/// their centre, and the corners of a cube of edge `least` there.
Points around(const Points& points, double times, double least) {
  const Vec3 middle = 0.5 * (points.rowwise().minCoeff() + points.rowwise().maxCoeff());
  Points out(3, points.cols() + 8);
  out.leftCols(points.cols()) = (times * (points.colwise() - middle)).colwise() + middle;
  for (int i = 0; i < 8; ++i)
    out.col(points.cols() + i) = middle + 0.5 * least * Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  return out;
}

double extent(const Points& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

Points corners_of(const std::vector<loop::ProxyShape>& proxies) {
  Eigen::Index count = 0;
  for (const loop::ProxyShape& proxy : proxies) count += proxy.surface.vertices.cols();
  Points out(3, count);
  count = 0;
  for (const loop::ProxyShape& proxy : proxies) {
    out.middleCols(count, proxy.surface.vertices.cols()) = proxy.surface.vertices;
    count += proxy.surface.vertices.cols();
  }
  return out;
}

/// Adds the hulls as translucent surfaces with dark edges; each side has one entry in the legend.
void add_proxies(render::Scene& scene, const std::vector<loop::ProxyShape>& proxies, double size) {
  bool named_a = false, named_b = false;
  for (const loop::ProxyShape& proxy : proxies) {
    if (proxy.surface.faces.cols() == 0) continue;
    bool& named = proxy.of_a ? named_a : named_b;
    render::Surface hull{named        ? ""
                         : proxy.of_a ? "proxies in contact"
                                      : "proxies of the other side",
                         proxy.surface.vertices, proxy.surface.faces};
    named = true;
    hull.colour = proxy.of_a ? kHullA : kHullB;
    hull.opacity = 0.28;
    hull.crease_deg = 1.0;
    render::Surface edges =
        render::outline(proxy.surface.vertices, proxy.surface.faces, 0.002 * size, kSharp);
    edges.colour = hull.colour;
    scene.surfaces.push_back(std::move(hull));
    scene.surfaces.push_back(std::move(edges));
  }
}

render::Options panel_options() {
  render::Options options;
  options.width = options.height = kPanel;
  return options;
}

render::Picture overview(render::Scene scene, const loop::ContactInstant& contact, const Patch& patch,
                         const std::string& title) {
  for (render::Surface& surface : scene.surfaces) {
    surface.values = {};
    if (surface.name != "tool") surface.colour = kPlain;
    surface.opacity = surface.name == "tool" ? 0.35 : 0.45;
  }
  render::Options options = panel_options();
  options.view = across(patch.outward);
  const Points hulls = corners_of(contact.proxies);
  options.frame =
      around(hulls.cols() > 0 ? hulls : patch.vertices, hulls.cols() > 0 ? 1.3 : 4.0, 12.0 * patch.edge);
  const double size = extent(options.frame);
  add_proxies(scene, contact.proxies, size);
  scene.title = title;
  const auto of = [&](bool a) {
    return std::count_if(contact.proxies.begin(), contact.proxies.end(),
                         [&](const loop::ProxyShape& p) { return p.of_a == a; });
  };
  scene.subtitle = contact.proxies.empty()
                       ? "without proxies"
                       : fmt::format("proxies in contact: {} against {}", of(true), of(false));
  return render::draw(scene, options);
}

render::Picture close_up(render::Scene scene, const Patch& patch) {
  render::Options options = panel_options();
  options.view = from_side(patch.outward, 18.0);
  options.frame = around(patch.vertices, 1.35, 12.0 * patch.edge);
  const double size = extent(options.frame);
  // The touching bodies lie in front of the patch; they are translucent to keep the contact visible.
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    render::Surface& surface = scene.surfaces[i];
    if (i == patch.body) {
      surface.colour = kPlain;
      continue;
    }
    surface.values = {};
    surface.opacity = 0.13;
  }
  render::Surface vertices =
      render::dots(patch.vertices, std::clamp(0.4 * patch.edge, 0.003 * size, 0.015 * size));
  vertices.name = "colliding vertices";
  vertices.colour = kVertex;
  scene.surfaces.push_back(std::move(vertices));
  scene.subtitle =
      fmt::format("{}: {} colliding vertices", scene.surfaces[patch.body].name, patch.vertices.cols());
  return render::draw(scene, options);
}

/// Returns the part of the grid with penetration, and a margin of one pixel.
render::Field pressed_part(const contact::RegionView& region) {
  int low_c = region.width, high_c = -1, low_r = region.height, high_r = -1;
  const auto gap = [&](int c, int r) {
    return region.gap[static_cast<std::size_t>(r) * static_cast<std::size_t>(region.width) +
                      static_cast<std::size_t>(c)];
  };
  for (int r = 0; r < region.height; ++r)
    for (int c = 0; c < region.width; ++c)
      if (gap(c, r) < 0.0) {
        low_c = std::min(low_c, c), high_c = std::max(high_c, c);
        low_r = std::min(low_r, r), high_r = std::max(high_r, r);
      }
  low_c = std::max(low_c - 1, 0), low_r = std::max(low_r - 1, 0);
  high_c = std::min(high_c + 1, region.width - 1), high_r = std::min(high_r + 1, region.height - 1);
  render::Field field;
  field.width = high_c - low_c + 1;
  field.height = high_r - low_r + 1;
  field.cell = region.pixel;
  for (int r = low_r; r <= high_r; ++r)
    for (int c = low_c; c <= high_c; ++c) field.values.push_back(gap(c, r) < 0.0 ? -gap(c, r) : std::nan(""));
  return field;
}

/// Returns the overlap volume of the bodies [m^3].
double overlap(const contact::RegionView& region) {
  double sum = 0.0;
  for (const double gap : region.gap)
    if (gap < 0.0) sum -= gap * region.pixel * region.pixel;
  return sum;
}

render::Picture depth_picture(const std::vector<contact::RegionView>& regions, const std::string& title) {
  const auto largest = std::max_element(regions.begin(), regions.end(),
                                        [](const auto& p, const auto& q) { return overlap(p) < overlap(q); });
  const auto pressed = std::count_if(regions.begin(), regions.end(),
                                     [](const auto& region) { return loop::deepest(region) > 0.0; });
  const render::Field field = pressed_part(*largest);
  const double volume = overlap(*largest);
  render::ColourScale scale;
  scale.label = "penetration";
  scale.unit = "m";
  scale.low = 0.0;
  const std::string which = pressed > 1 ? fmt::format("the largest of {} regions: ", pressed) : std::string();
  return render::draw_field(
      field, scale, title, 0,
      fmt::format("{}pixels of {:.3g} mm, overlap {:.3g} {}", which, 1e3 * largest->pixel,
                  volume < 1e-6 ? 1e9 * volume : 1e6 * volume, volume < 1e-6 ? "mm³" : "cm³"));
}

}  // namespace

void PeakContactPicture::queried(loop::World& world, double t) {
  double force = 0.0;
  for (const contact::ContactPoint& p : world.contact->points(world.state.view()))
    force += p.pressure * p.area;
  if (force <= contact_.force_n) return;
  contact_ = loop::contact_instant(world);
  snapshot_ = snapshot_of(world, t, Shade::kPenetration);
}

void PeakContactPicture::save(const loop::World& world, const std::string& folder,
                              MissingOutputs& missing) const {
  const auto keep = [&](const char* name, auto draw) {
    const std::string path = (std::filesystem::path(folder) / name).string();
    std::error_code none;
    std::filesystem::remove(path, none);  // a file of an earlier run would pass for one of this run
    try {
      render::save_png(draw(), path);
    } catch (const Error& e) { missing.add("picture " + path, e.what()); }
  };
  const std::string title =
      fmt::format("{}, contact at t = {} s", world.description.name, time_text(snapshot_.time));
  keep("contact.png", [&] {
    if (!touched()) fail("no contact occurred in this run");
    const render::Scene scene = scene_of(world, snapshot_, Shade::kPenetration);
    const Patch patch = largest_patch(scene, contact_);
    if (patch.vertices.cols() == 0)
      fail("no surface vertex of a body lies inside the other side of the contact");
    return render::beside({overview(scene, contact_, patch, title), close_up(scene, patch)});
  });
  const bool pixels = std::any_of(contact_.regions.begin(), contact_.regions.end(),
                                  [](const auto& region) { return loop::deepest(region) > 0.0; });
  std::error_code none;
  std::filesystem::remove(std::filesystem::path(folder) / "depth.png", none);
  if (pixels) keep("depth.png", [&] { return depth_picture(contact_.regions, title); });
}

}  // namespace palpate::session
