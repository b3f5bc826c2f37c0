#pragma once
// One mesh of one domain by CGAL's Mesh_3, as a template over the kind of domain.  Heavy to compile: included
// by polyhedral.cpp and implicit.cpp alone.
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include <array>
#include <optional>
#include <unordered_map>
#include <vector>

#include "cell_search.h"
#include "fit_volume.h"
#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// Two points on both sides of the surface; refinement starts where the line between them meets it.
using Seed = std::array<Vec3, 2>;

template <class Domain>
class Mesher : public CellMesher {
 public:
  using Triangulation =
      typename CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
  using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, typename Domain::Corner_index,
                                                          typename Domain::Curve_index>;
  using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
  using Segment = typename Domain::Segment_3;
  using Point = typename Domain::Point_3;

  Mesher(const Domain& domain, bool creased, std::vector<Seed> seeds)
      : domain_(domain), creased_(creased), seeds_(std::move(seeds)) {}

  CellCount refine(double cell_size, double facet_size) override {
    namespace P = CGAL::parameters;
    // Angles of at least 25 degrees on the surface end provably (up to 30); a facet may leave the surface by
    // a tenth of its size, what is left of that in volume fit_volume() takes away.  Edges of creases are as
    // long as those beside them.
    const Criteria criteria(P::edge_size = facet_size, P::facet_angle = 25.0, P::facet_size = facet_size,
                            P::facet_distance = 0.1 * facet_size, P::cell_radius_edge_ratio = 2.0,
                            P::cell_size = cell_size);
    CGAL::get_default_random() = CGAL::Random(0);
    complex_ = Complex();
    CGAL::Mesh_3::internal::C3t3_initializer<Complex, Domain, Criteria, true>()(complex_, domain_, criteria,
                                                                                creased_);
    sow();
    CGAL::refine_mesh_3(complex_, domain_, criteria, P::no_perturb(), P::no_exude(), P::no_odt(),
                        P::no_lloyd(), P::no_reset_c3t3(), P::manifold());
    CellCount out;
    out.tetrahedra = static_cast<int>(complex_.number_of_cells_in_complex());
    // a few of them may belong to no tetrahedron
    out.nodes = static_cast<int>(complex_.triangulation().number_of_vertices());
    out.mean_edge = mean_edge();
    return out;
  }

  void optimise(const Progress& progress) override {
    using Sliver = CGAL::Mesh_3::Min_dihedral_angle_criterion<Triangulation>;
    using Perturber = CGAL::Mesh_3::Sliver_perturber<Complex, Domain, Sliver, Told>;
    constexpr double kWantedDeg = 12.0;  // the bound is raised degree by degree up to this one
    const Sliver sliver(kWantedDeg, complex_.triangulation());
    Perturber perturber(complex_, domain_, sliver);
    for (auto* perturbation : CGAL::default_perturbation_vector(complex_, domain_, sliver))
      perturber.add_perturbation(perturbation);
    perturber(Told{&progress, kWantedDeg});
    CGAL::exude_mesh_3(complex_);
    if (progress) progress(1.0);
  }

  /// The tetrahedra, numbered in the order in which they were made; `on_crease` a node.
  FittedMesh take() override {
    const Triangulation& all = complex_.triangulation();
    // looked up only: its order is never used
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

  /// Where the line from a to b meets the surface.
  std::optional<Vec3> crossing(const Vec3& a, const Vec3& b) const override {
    const Segment line(point(a), point(b));
    if (!domain_.do_intersect_surface_object()(line)) return std::nullopt;
    const auto met = domain_.construct_intersection_object()(line);
    if (std::get<2>(met) == 0) return std::nullopt;
    return at(std::get<0>(met));
  }

 private:
  /// Hears from the perturber when a bound was reached [degrees].
  struct Told {
    const Progress* progress = nullptr;
    double wanted = 1.0;
    void bound_reached(double bound) const {
      if (progress && *progress) (*progress)(0.7 * bound / wanted);
    }
    void end_of_perturbation_iteration(std::size_t) const {}
  };

  static Point point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
  static Vec3 at(const Point& p) { return {p.x(), p.y(), p.z()}; }

  void sow() {
    for (const Seed& seed : seeds_) {
      const Segment line(point(seed[0]), point(seed[1]));
      if (!domain_.do_intersect_surface_object()(line)) continue;
      const auto met = domain_.construct_intersection_object()(line);
      if (std::get<2>(met) == 0) continue;
      const auto vertex =
          complex_.triangulation().insert(typename Triangulation::Weighted_point(std::get<0>(met)));
      if (vertex == typename Triangulation::Vertex_handle()) continue;  // hidden by the ball of a crease
      if (complex_.in_dimension(vertex) >= 0 && complex_.in_dimension(vertex) < 2) continue;
      complex_.set_dimension(vertex, 2);
      complex_.set_index(vertex, std::get<1>(met));
    }
  }

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
  Complex complex_;
};

}  // namespace palpate::model
