#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>

#include <numbers>

#include "mesher.h"
#include "model/tetrahedralise.h"
#include "palpate/core/error.h"
#include "polylines.h"

namespace palpate::model {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using ImplicitDomain = CGAL::Mesh_domain_with_polyline_features_3<CGAL::Labeled_mesh_domain_3<Kernel>>;

/// Estimates the volume of the inside from lattice points, accurate enough to start the search [m^3].
double lattice_volume(const std::function<double(const Vec3&)>& f, const Vec3& centre, double radius) {
  constexpr int kCells = 48;
  const double width = 2 * radius / kCells;
  int inside = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j)
      for (int k = 0; k < kCells; ++k)
        inside += f(centre + width * (Vec3(i, j, k).array() + 0.5 - kCells / 2.0).matrix()) < 0;
  return inside * width * width * width;
}

}  // namespace

Tetrahedra tetrahedralise(const std::function<double(const Vec3&)>& f, const Vec3& centre, double radius,
                          const TetrahedraOptions& options, const Progress& progress) {
  if (!(radius > 0 && std::isfinite(radius)))
    fail("the ball around an implicit surface has radius {} m, must be positive", radius);
  if (!(f(centre) < 0))
    fail("the implicit function is {} at the centre ({}, {}, {}) m, must be negative inside", f(centre),
         centre.x(), centre.y(), centre.z());
  const auto value = [&f](const Kernel::Point_3& p) { return f(Vec3(p.x(), p.y(), p.z())); };
  constexpr double kRelativeError = 1e-7;  // error of surface points found by bisection [radii]
  try {
    CGAL::Random random(0);
    namespace P = CGAL::parameters;
    const Kernel::Sphere_3 ball(Kernel::Point_3(centre.x(), centre.y(), centre.z()), radius * radius);
#if CGAL_VERSION_MAJOR >= 6  // parameters are chained from 6 on, and objects in 5.5
    ImplicitDomain domain = ImplicitDomain::create_implicit_mesh_domain(
        value, ball, P::relative_error_bound(kRelativeError).p_rng(&random));
#else
    ImplicitDomain domain = ImplicitDomain::create_implicit_mesh_domain(
        value, ball, P::relative_error_bound = kRelativeError, P::p_rng = &random);
#endif
    std::vector<std::vector<Kernel::Point_3>> lines;
    for (const Polyline& line : cut_at_corners(options.creases)) {
      lines.emplace_back();
      for (const Vec3& p : line) lines.back().emplace_back(p.x(), p.y(), p.z());
    }
    if (!lines.empty()) domain.add_features(lines.begin(), lines.end());
    Meter meter(options.limits);
    const double volume = lattice_volume(f, centre, radius);
    Mesher<ImplicitDomain> mesher(domain, options, {}, {volume, 4 * std::numbers::pi * radius * radius},
                                  meter);
    return search_cells(mesher, volume, false, options, progress);
  } catch (const CGAL::Failure_exception& e) {
    fail("the inside of the implicit surface cannot be filled with tetrahedra; CGAL reports: {}",
         reason_of(e));
  }
}

}  // namespace palpate::model
