#pragma once
// Mesh of a domain by CGAL's Mesh_3, as a template over the kind of domain.  Heavy to compile: include it
// only in polyhedral.cpp and implicit.cpp.
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/lloyd_optimize_mesh_3.h>
#include <CGAL/make_mesh_3.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "cell_search.h"
#include "cgal_failure.h"
#include "fit_volume.h"
#include "metered_criteria.h"
#include "palpate/core/error.h"
#include "palpate/mesh/mesh.h"
#include "quality_gate.h"

namespace palpate::model {

/// Two points on both sides of the surface; refinement starts where the segment between them meets it.
using Seed = std::array<Vec3, 2>;

template <class Domain>
class Mesher : public CellMesher {
 public:
  using Triangulation =
      typename CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
  using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, typename Domain::Corner_index,
                                                          typename Domain::Curve_index>;
  using Criteria = MeteredCriteria<Triangulation>;
  using Segment = typename Domain::Segment_3;
  using Point = typename Domain::Point_3;

  Mesher(const Domain& domain, const TetrahedraOptions& options, std::vector<Seed> seeds,
         const BodySize& size, Meter& meter)
      : domain_(domain),
        creased_(options.crease_deg || !options.creases.empty()),
        seeds_(std::move(seeds)),
        size_(size),
        meter_(meter),
        stage_(options.stage),
        optimisation_(options.optimisation) {}

  // Refinement cannot produce a manifold boundary at an edge that is much sharper than a right angle and not
  // protected as a crease: however small the facets are there, both sides meet in some of them, and they are
  // split without end.  When facets vanish or the number of points runs away, refinement restarts without
  // that condition and with a least size of facets and cells, below which none is split.  Each point is then
  // at least a fixed distance from all others, so that their number is bounded; places where the boundary
  // still touches itself are removed afterwards (manifold.h).
  CellCount refine(double cell_size, double facet_size, const Progress& progress) override {
    if (stage_) stage_(kRefining);
    const double expected = size_.points(cell_size, facet_size);
    meter_.begin(expected, progress);
    if (!least_size_) {
      const std::optional<Runaway> runaway =
          refined(cell_size, facet_size, kRunawayAlways + kRunawayFactor * expected, true);
      if (!runaway) return counted();
      least_size_ = true;
      const Vec3& at = runaway->place;
      note_ = fmt::format(
          "at ({:.4g}, {:.4g}, {:.4g}) m the surface is too sharp or too thin for boundary faces of {:.2g} "
          "m: they shrank to {:.2g} m; refinement was restarted with none below {:.0f} % of the target size",
          at.x(), at.y(), at.z(), facet_size, runaway->size, 100 * kLeastSize);
    }
    if (const std::optional<Runaway> runaway = refined(cell_size, facet_size, meter_.points(), false)) {
      const Vec3& at = runaway->place;
      fail(
          "the tetrahedra need more than {} points, most of them around ({:.4g}, {:.4g}, {:.4g}) m, where "
          "edges are as short as {:.3g} m; use larger elements, or raise --points",
          meter_.points(), at.x(), at.y(), at.z(), runaway->size);
    }
    return counted();
  }

  // The perturber stops at the first bound that it cannot reach, with CGAL 6.0 at 2 degrees on the gear of
  // the paper's scenes, where 5.5 reaches 11 on nearly the same mesh.  If that is below any limit of the
  // gate, all vertices off the creases are moved towards the centroids of their Voronoi cells (Lloyd's
  // method; Du and Wang 2003), and the perturber starts again: 12 degrees there.
  void optimise(const Progress& progress) override {
    constexpr int kIterations = 10;
    stage(kMovingVertices, optimisation_.move_vertices, optimisation_.why_not_moved, [&] {
      Bound bound{progress};
      perturb(bound);
      if (bound.reached < kSharpDihedralDeg) {
        CGAL::lloyd_optimize_mesh_3(complex_, domain_, CGAL::parameters::time_limit = meter_.seconds_left(),
                                    CGAL::parameters::max_iteration_number = kIterations);
        meter_.check("while vertices were moved to centroids");
        perturb(bound);
      }
    });
    stage(kExudingSlivers, optimisation_.exude_slivers, optimisation_.why_not_exuded, [&] {
      CGAL::exude_mesh_3(complex_, CGAL::parameters::time_limit = meter_.seconds_left());
      meter_.check("while slivers were exuded");
    });
    if (progress) progress(1.0);
  }

  /// Returns the tetrahedra, numbered in the order in which they were made.
  FittedMesh take() override {
    const Triangulation& all = complex_.triangulation();
    // Used for look-up only, so its order does not affect the result.
    std::unordered_map<typename Triangulation::Vertex_handle, int> number;
    for (auto cell = complex_.cells_in_complex_begin(); cell != complex_.cells_in_complex_end(); ++cell)
      for (int k = 0; k < 4; ++k) number.emplace(cell->vertex(k), -1);
    FittedMesh out;
    int count = 0;
    out.mesh.nodes.resize(3, static_cast<Eigen::Index>(number.size()));
    for (auto vertex = all.finite_vertices_begin(); vertex != all.finite_vertices_end(); ++vertex) {
      const auto found = number.find(vertex);
      if (found == number.end()) continue;
      found->second = count;
      out.mesh.nodes.col(count++) = at(vertex->point().point());
      out.on_crease.push_back(vertex->in_dimension() < 2);
    }
    out.mesh.tets.resize(4, static_cast<Eigen::Index>(complex_.number_of_cells_in_complex()));
    Eigen::Index tet = 0;
    for (auto cell = complex_.cells_in_complex_begin(); cell != complex_.cells_in_complex_end();
         ++cell, ++tet)
      for (int k = 0; k < 4; ++k) out.mesh.tets(k, tet) = number.at(cell->vertex(k));
    return out;
  }

  double thickness() const override { return size_.thickness(); }

  std::vector<std::string> notes() const override {
    std::vector<std::string> out;
    if (!note_.empty()) out.push_back(note_);
    const auto left_out = [&](bool done, const char* stage, const std::string& why) {
      if (!done)
        out.push_back(fmt::format("the step \"{}\" was skipped, because CGAL failed in it: {}", stage, why));
    };
    left_out(optimisation_.move_vertices, kMovingVertices, optimisation_.why_not_moved);
    left_out(optimisation_.exude_slivers, kExudingSlivers, optimisation_.why_not_exuded);
    return out;
  }

  /// Returns the point where the segment from a to b meets the surface.
  std::optional<Vec3> crossing(const Vec3& a, const Vec3& b) const override {
    const Segment line(point(a), point(b));
    if (!domain_.do_intersect_surface_object()(line)) return std::nullopt;
    const auto met = domain_.construct_intersection_object()(line);
    if (std::get<2>(met) == 0) return std::nullopt;
    return at(std::get<0>(met));
  }

 private:
  /// Limits beyond which a refinement counts as a runaway: points, as a constant plus a multiple of the
  /// estimate (creases and thin places need more than the estimate).
  static constexpr double kRunawayAlways = 20'000, kRunawayFactor = 6.0;
  static constexpr double kVanishing = 1e-3;  ///< facets below this share of the target size
  static constexpr double kLeastSize = 0.1;   ///< least size of cells and facets that are split, in target
                                              ///< sizes

  /// Runs one stage of optimisation.  If CGAL throws in it, the complex is in an undefined state: the stage
  /// is skipped from now on.
  template <class Work>
  void stage(const char* name, bool& requested, std::string& why_not, const Work& work) {
    if (!requested) return;
    if (stage_) stage_(name);
    try {
      work();
    } catch (const Error&) { throw; } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& e) {
      requested = false;
      why_not = reason_of(e);
      throw OptimisationFailed{};
    }
  }

  /// Refines from nothing; returns where it ran away, if it did.
  std::optional<Runaway> refined(double cell_size, double facet_size, double largest, bool manifold) {
    namespace P = CGAL::parameters;
    // Surface angles of at least 25 degrees are reached provably (up to 30).  A facet may deviate from the
    // surface by a tenth of its size; fit_volume() removes the remaining volume error.  Crease edges are as
    // long as facets.
    const double least = manifold ? 0.0 : kLeastSize, vanishing = manifold && !creased_ ? kVanishing : 0.0;
    const Criteria criteria(MeteredEdges<Triangulation>(facet_size, meter_),
                            MeteredFacets<Triangulation>({25.0, facet_size, 0.1 * facet_size},
                                                         least * facet_size, vanishing * facet_size, meter_),
                            MeteredCells<Triangulation>({2.0, cell_size}, least * cell_size, meter_));
    CGAL::get_default_random() = CGAL::Random(0);
    complex_ = Complex();
    CGAL::Mesh_error_code error = CGAL::CGAL_MESH_3_NO_ERROR;
    const auto bounded = [&](double points) {
      return P::mesh_3_options(P::maximal_number_of_vertices = static_cast<std::size_t>(points),
                               P::pointer_to_error_code = &error);
    };
    P::internal::Mesh_3_options first;
    first.maximal_number_of_vertices = static_cast<std::size_t>(meter_.points());
    first.pointer_to_error_code = &error;
    try {
      CGAL::Mesh_3::internal::C3t3_initializer<Complex, Domain, Criteria, true>()(complex_, domain_, criteria,
                                                                                  creased_, first);
      if (error != CGAL::CGAL_MESH_3_NO_ERROR) refuse_creases();
      sow();
      const auto topology = manifold ? P::manifold() : P::non_manifold();
      CGAL::refine_mesh_3(complex_, domain_, criteria, P::no_perturb(), P::no_exude(), P::no_odt(),
                          P::no_lloyd(), P::no_reset_c3t3(), topology,
                          bounded(std::min<double>(largest, meter_.points())));
    } catch (const Runaway& runaway) { return runaway; }
    if (error != CGAL::CGAL_MESH_3_NO_ERROR) return crowded();
    return std::nullopt;
  }

  /// Throws Error: the creases need more points than the limit.
  [[noreturn]] void refuse_creases() const {
    const Runaway at = crowded();
    fail(
        "the creases need more than {} points, most of them around ({:.4g}, {:.4g}, {:.4g}) m, where they "
        "are as short as {:.3g} m; keep fewer with --creases, or raise --points",
        meter_.points(), at.place.x(), at.place.y(), at.place.z(), at.size);
  }

  /// Counts the present mesh.
  CellCount counted() const {
    CellCount out;
    out.tetrahedra = static_cast<int>(complex_.number_of_cells_in_complex());
    // A few of these vertices may belong to no tetrahedron.
    out.nodes = static_cast<int>(complex_.triangulation().number_of_vertices());
    out.mean_edge = mean_edge();
    return out;
  }

  /// Returns the midpoint of the shortest edge, and its length.
  Runaway crowded() const {
    const Triangulation& all = complex_.triangulation();
    Runaway out{Vec3::Zero(), std::numeric_limits<double>::infinity()};
    for (auto edge = all.finite_edges_begin(); edge != all.finite_edges_end(); ++edge) {
      const Vec3 a = at(edge->first->vertex(edge->second)->point().point()),
                 b = at(edge->first->vertex(edge->third)->point().point());
      if ((a - b).norm() < out.size) out = {(a + b) / 2, (a - b).norm()};
    }
    return out;
  }

  static constexpr double kWantedDeg = 12.0;  ///< the perturber raises its bound degree by degree up to this

  /// Last bound on dihedral angles that the perturber reached [degrees], with its share of the progress.
  struct Bound {
    const Progress& progress;
    double reached = 0.0, share = 0.0;
  };
  struct ProgressVisitor {
    Bound* bound = nullptr;
    void bound_reached(double degrees) const {
      bound->reached = degrees;
      bound->share = std::max(bound->share, 0.7 * degrees / kWantedDeg);
      if (bound->progress) bound->progress(bound->share);
    }
    void end_of_perturbation_iteration(std::size_t) const {}
  };

  /// Moves single vertices to enlarge the smallest dihedral angles, until a bound cannot be reached.
  void perturb(Bound& bound) {
    using Sliver = CGAL::Mesh_3::Min_dihedral_angle_criterion<Triangulation>;
    using Perturber = CGAL::Mesh_3::Sliver_perturber<Complex, Domain, Sliver, ProgressVisitor>;
    const Sliver sliver(kWantedDeg, complex_.triangulation());
    Perturber perturber(complex_, domain_, sliver);
    for (auto* perturbation : CGAL::default_perturbation_vector(complex_, domain_, sliver))
      perturber.add_perturbation(perturbation);
    perturber.set_time_limit(meter_.seconds_left());
    bound.reached = 0.0;
    perturber(ProgressVisitor{&bound});
    meter_.check("while vertices were moved for larger angles");
  }

  static Point point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
  static Vec3 at(const Point& p) { return {p.x(), p.y(), p.z()}; }

  /// Inserts the intersections of the seeds with the surface as first vertices.
  void sow() {
    for (const Seed& seed : seeds_) {
      const Segment line(point(seed[0]), point(seed[1]));
      if (!domain_.do_intersect_surface_object()(line)) continue;
      const auto met = domain_.construct_intersection_object()(line);
      if (std::get<2>(met) == 0) continue;
      const auto vertex =
          complex_.triangulation().insert(typename Triangulation::Weighted_point(std::get<0>(met)));
      if (vertex == typename Triangulation::Vertex_handle())
        continue;  // hidden by the protecting ball of a
                   // crease
      if (complex_.in_dimension(vertex) >= 0 && complex_.in_dimension(vertex) < 2) continue;
      complex_.set_dimension(vertex, 2);
      complex_.set_index(vertex, std::get<1>(met));
    }
  }

  /// Returns the mean edge length over all tetrahedra [m].
  double mean_edge() const {
    double sum = 0;
    for (auto cell = complex_.cells_in_complex_begin(); cell != complex_.cells_in_complex_end(); ++cell)
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < i; ++j)
          sum += (at(cell->vertex(i)->point().point()) - at(cell->vertex(j)->point().point())).norm();
    return sum / (6.0 * static_cast<double>(std::max<std::size_t>(complex_.number_of_cells_in_complex(), 1)));
  }

  const Domain& domain_;
  bool creased_;
  std::vector<Seed> seeds_;
  BodySize size_;
  Meter& meter_;
  std::function<void(const std::string&)> stage_;
  Optimisation optimisation_;
  bool least_size_ = false;  ///< facets or points ran away before
  std::string note_;
  Complex complex_;
};

}  // namespace palpate::model
