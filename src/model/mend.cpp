#include "mend.h"

#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "cgal_surface.h"
#include "crossings.h"
#include "shells.h"

namespace palpate::model {
namespace {
namespace PMP = CGAL::Polygon_mesh_processing;

/// Returns an existing property map, which CGAL 5.5 returns as the first of a pair and 6.0 as an optional.
template <class Found>
auto map_of(const Found& found) {
  if constexpr (requires { found.first; })
    return found.first;
  else
    return *found;
}

/// Hole in a surface.
struct Hole {
  CgalSurface::Halfedge_index border;
  int edges = 0;
  double across = 0.0;      ///< largest distance of a border vertex from the first [m]
  double least_area = 0.0;  ///< lower bound on the area of its closure [m^2]
};

/// Measures a hole.  The area of a surface is at least the length of its area vector, which its border alone
/// determines: half the sum of p x q over the border's edges.
Hole hole_at(const CgalSurface& mesh, CgalSurface::Halfedge_index border) {
  Hole out{border};
  const auto start = mesh.point(mesh.target(border));
  Kernel::Vector_3 twice(0, 0, 0);
  for (const auto h : mesh.halfedges_around_face(border)) {
    const auto to = mesh.point(mesh.target(h));
    ++out.edges;
    out.across = std::max(out.across, std::sqrt(CGAL::squared_distance(start, to)));
    twice = twice + CGAL::cross_product(mesh.point(mesh.source(h)) - start, to - start);
  }
  out.least_area = std::sqrt(twice.squared_length()) / 2;
  return out;
}

/// Closes all holes, or rejects the surface before the first is closed if they are plainly too large.  The
/// bound applies to all of them together, because loose triangles could each be closed separately.
int close_holes(CgalSurface& mesh, const Soup& soup, double largest_share, int& faces_added) {
  std::vector<CgalSurface::Halfedge_index> borders;
  PMP::extract_boundary_cycles(mesh, std::back_inserter(borders));
  if (borders.empty()) return 0;
  const double whole = PMP::area(mesh);
  const auto refuse = [&](const Hole& hole, const std::string& why) {
    const auto vertex = mesh.target(hole.border);
    const int source = map_of(mesh.property_map<CgalSurface::Vertex_index, int>("v:source"))[vertex];
    const auto at = mesh.point(vertex);
    fail(
        "{} at ({:.6g}, {:.6g}, {:.6g}) m: the surface has a hole of {} edges, {:.3g} m across, {}; the "
        "surface of a body must be closed",
        source >= 0 ? soup.from->node(source) : soup.from->source, at.x(), at.y(), at.z(), hole.edges,
        hole.across, why);
  };
  const auto refuse_beyond = [&](const Hole& hole, double area) {
    if (area <= largest_share * whole) return;
    refuse(hole,
           fmt::format("{} would add {:.0f} % to its area, more than {:.0f} %",
                       borders.size() == 1 ? "whose closing"
                                           : fmt::format("and closing this and {} more", borders.size() - 1),
                       100 * area / whole, 100 * largest_share));
  };
  std::vector<Hole> holes;
  double least = 0.0;
  for (const auto border : borders) least += holes.emplace_back(hole_at(mesh, border)).least_area;
  refuse_beyond(*std::max_element(holes.begin(), holes.end(),
                                  [](const Hole& a, const Hole& b) { return a.least_area < b.least_area; }),
                least);
  double added = 0.0;
  for (const Hole& hole : holes) {
    std::vector<CgalSurface::Face_index> patch;
    // A patch that could not be faired is flat, and is accepted.
#if CGAL_VERSION_MAJOR >= 6
    PMP::triangulate_refine_and_fair_hole(mesh, hole.border,
                                          CGAL::parameters::face_output_iterator(std::back_inserter(patch)));
#else
    std::vector<CgalSurface::Vertex_index> fresh;
    PMP::triangulate_refine_and_fair_hole(mesh, hole.border, std::back_inserter(patch),
                                          std::back_inserter(fresh));
#endif
    if (patch.empty()) refuse(hole, "which cannot be triangulated");
    added += PMP::area(patch, mesh);
    refuse_beyond(hole, added);
    faces_added += static_cast<int>(patch.size());
  }
  return static_cast<int>(holes.size());
}

/// Removes faces that are too flat: those that CGAL can collapse exactly, then needles and caps.
void collapse_degenerate(CgalSurface& mesh, const mesh::Provenance& from) {
  PMP::remove_degenerate_edges(mesh);
  PMP::remove_degenerate_faces(mesh);
  const Soup now = soup_of(mesh, from);
  bool needles = false;
  const auto flat = [&](const std::array<int, 3>& f) {
    const auto at = [&](std::size_t k) -> const Vec3& {
      return now.vertices[static_cast<std::size_t>(f[k])];
    };
    const double longest = std::max(
        {(at(1) - at(0)).squaredNorm(), (at(2) - at(1)).squaredNorm(), (at(0) - at(2)).squaredNorm()});
    return !((at(1) - at(0)).cross(at(2) - at(0)).norm() > 1e-7 * longest);
  };
  for (const auto& f : now.faces) needles |= flat(f);
  if (!needles) return;
  const double whole = now.diagonal();
  const double cap = std::cos(179.99 * CGAL_PI / 180), needle = 1e5, shortest = 1e-4 * whole;
#if CGAL_VERSION_MAJOR >= 6
  PMP::remove_almost_degenerate_faces(
      mesh,
      CGAL::parameters::cap_threshold(cap).needle_threshold(needle).collapse_length_threshold(shortest));
#else
  PMP::experimental::remove_almost_degenerate_faces(mesh, cap, needle, shortest);
#endif
}

/// Builds the mesh of one shell, so that intersections between different shells are not attributed to it.
CgalSurface shell_mesh(const Soup& soup, const std::vector<int>& faces) {
  Soup one = soup;
  one.faces.clear();
  one.face_source.clear();
  for (const int f : faces) {
    one.faces.push_back(soup.faces[static_cast<std::size_t>(f)]);
    one.face_source.push_back(soup.face_source[static_cast<std::size_t>(f)]);
  }
  drop_unused(one);
  return cgal_of(one);
}

void append(Soup& all, const Soup& one) {
  const int first = static_cast<int>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), one.vertices.begin(), one.vertices.end());
  all.vertex_source.insert(all.vertex_source.end(), one.vertex_source.begin(), one.vertex_source.end());
  for (const auto& f : one.faces) all.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  all.face_source.insert(all.face_source.end(), one.face_source.begin(), one.face_source.end());
}

int turn(Soup& soup) {
  std::vector<Kernel::Point_3> points;
  // CGAL duplicates vertices where it separates the surface; the copies have the coordinates of old vertices.
  std::map<std::array<double, 3>, int> source;
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    points.emplace_back(soup.vertices[v].x(), soup.vertices[v].y(), soup.vertices[v].z());
    source.emplace(std::array{soup.vertices[v].x(), soup.vertices[v].y(), soup.vertices[v].z()},
                   soup.vertex_source[v]);
  }
  std::vector<std::vector<std::size_t>> faces;
  for (const auto& f : soup.faces)
    faces.push_back(
        {static_cast<std::size_t>(f[0]), static_cast<std::size_t>(f[1]), static_cast<std::size_t>(f[2])});
  PMP::orient_polygon_soup(points, faces);
  const auto position = [&](std::size_t v) { return Vec3(points[v].x(), points[v].y(), points[v].z()); };
  for (std::size_t v = soup.vertices.size(); v < points.size(); ++v) {
    soup.vertices.push_back(position(v));
    soup.vertex_source.push_back(source.at({points[v].x(), points[v].y(), points[v].z()}));
  }
  // A turned face lists its corners in the other order, whatever vertices they were given, so its normal
  // reverses.
  std::vector<char> turned;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto before = [&](int k) -> const Vec3& {
      return soup.vertices[static_cast<std::size_t>(soup.faces[f][static_cast<std::size_t>(k)])];
    };
    const Vec3 old_normal = (before(1) - before(0)).cross(before(2) - before(0));
    soup.faces[f] = {static_cast<int>(faces[f][0]), static_cast<int>(faces[f][1]),
                     static_cast<int>(faces[f][2])};
    turned.push_back(old_normal.dot((before(1) - before(0)).cross(before(2) - before(0))) < 0);
  }
  int count = 0;
  for (const std::vector<int>& shell : shells_of(soup.surface())) {
    const auto of_shell = std::count_if(shell.begin(), shell.end(),
                                        [&](int f) { return turned[static_cast<std::size_t>(f)] != 0; });
    const bool most = 2 * of_shell > static_cast<long>(shell.size());
    for (const int f : shell)
      if (most)
        std::swap(soup.faces[static_cast<std::size_t>(f)][1], soup.faces[static_cast<std::size_t>(f)][2]);
    count += static_cast<int>(most ? static_cast<long>(shell.size()) - of_shell : of_shell);
  }
  return count;
}

Mended mend_unguarded(const Soup& soup, double largest_hole,
                      const std::function<void(const std::string&)>& place) {
  Mended out;
  out.soup.from = soup.from;
  CgalSurface mesh = cgal_of(soup);
  PMP::stitch_borders(mesh);
  out.holes = close_holes(mesh, soup, largest_hole, out.hole_faces);
  const auto before = static_cast<long>(mesh.number_of_faces());
  collapse_degenerate(mesh, *soup.from);
  const Soup closed = soup_of(mesh, *soup.from);
  out.removed = static_cast<int>(before - static_cast<long>(closed.faces.size()));
  for (const std::vector<int>& shell : shells_of(closed.surface())) {
    CgalSurface one = shell_mesh(closed, shell);
    Soup sound = soup_of(one, *soup.from);
    if (const std::vector<int> crossing = crossing_faces(sound); !crossing.empty()) {
      out.crossings += static_cast<int>(crossing.size());
      if (place) place(sound.face_name(crossing[0]));
      CgalSurface repaired = one;
      const bool gone =
          PMP::experimental::remove_self_intersections(repaired, CGAL::parameters::preserve_genus(false));
      const Soup after = soup_of(repaired, *soup.from);
      if (gone && !after.faces.empty()) sound = after;
    }
    append(out.soup, sound);
  }
  return out;
}

}  // namespace

int orient_consistently(Soup& soup) {
  return guarded(soup, [&] { return turn(soup); });
}

Mended mend(const Soup& soup, double largest_hole, const std::function<void(const std::string&)>& place) {
  return guarded(soup, [&] { return mend_unguarded(soup, largest_hole, place); });
}

}  // namespace palpate::model
