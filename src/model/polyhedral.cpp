#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polyhedral_mesh_domain_with_features_3.h>

#include <algorithm>

#include "mesher.h"
#include "model/tetrahedralise.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "polylines.h"
#include "shells.h"

namespace palpate::model {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Polyhedron = CGAL::Mesh_polyhedron_3<Kernel>::type;
using PolyhedralDomain = CGAL::Polyhedral_mesh_domain_with_features_3<Kernel>;

Polyhedron polyhedron_of(const TriMesh& surface) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> faces;
  for (Eigen::Index v = 0; v < surface.vertices.cols(); ++v)
    points.emplace_back(surface.vertices(0, v), surface.vertices(1, v), surface.vertices(2, v));
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f)
    faces.push_back({static_cast<std::size_t>(surface.faces(0, f)),
                     static_cast<std::size_t>(surface.faces(1, f)),
                     static_cast<std::size_t>(surface.faces(2, f))});
  Polyhedron out;
  CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(points, faces, out);
  return out;
}

double area(const TriMesh& surface) {
  double out = 0;
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f) {
    const auto corner = [&](int k) -> Vec3 { return surface.vertices.col(surface.faces(k, f)); };
    out += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
  }
  return out;
}

/// Returns segments through the faces of each shell, spread over it: refinement finds a shell only if it
/// starts on it.
std::vector<Seed> seeds_of(const TriMesh& surface) {
  constexpr std::size_t kEach = 16;
  std::vector<Seed> out;
  for (const std::vector<int>& shell : shells_of(surface))
    for (std::size_t i = 0; i < kEach; ++i) {
      const int f = shell[i * shell.size() / kEach];
      const auto corner = [&](int k) -> Vec3 { return surface.vertices.col(surface.faces(k, f)); };
      const Vec3 middle = (corner(0) + corner(1) + corner(2)) / 3,
                 twice_area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
      const Vec3 step = 0.05 * twice_area / std::sqrt(twice_area.norm());
      out.push_back({middle - step, middle + step});
    }
  return out;
}

}  // namespace

Tetrahedra tetrahedralise(const TriMesh& surface, const TetrahedraOptions& options,
                          const Progress& progress) {
  const BodySize size{mesh::enclosed_volume(surface), area(surface)};
  refuse_too_thin(size, surface.vertices.col(0), options);
  Vec3 last = surface.vertices.col(0);
  const auto place = [&](const Vec3& at) {
    last = at;
    if (options.place) options.place(at);
  };
  try {
    PolyhedralDomain domain(polyhedron_of(surface));
    if (options.crease_deg) domain.detect_features(*options.crease_deg);
    if (!options.creases.empty()) {
      std::vector<std::vector<Kernel::Point_3>> lines;
      for (const Polyline& line : cut_at_corners(options.creases)) {
        lines.emplace_back();
        for (const Vec3& p : line) lines.back().emplace_back(p.x(), p.y(), p.z());
      }
      domain.add_features(lines.begin(), lines.end());
    }
    Meter meter(options.limits, place);
    Mesher<PolyhedralDomain> mesher(domain, options, seeds_of(surface), size, meter);
    return search_cells(mesher, size.volume, true, options, progress);
  } catch (const Error&) { throw; } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    fail("at ({:.4g}, {:.4g}, {:.4g}) m the surface cannot be filled with tetrahedra; CGAL reports: {}",
         last.x(), last.y(), last.z(), reason_of(e));
  }
}

}  // namespace palpate::model
