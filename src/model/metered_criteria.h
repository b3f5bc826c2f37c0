#pragma once
// CGAL's refinement criteria, extended by reports to a meter and by least sizes.
#include <CGAL/Mesh_criteria_3.h>

#include "meter.h"

namespace palpate::model {

/// Converts a CGAL point.
template <class Point>
Vec3 position(const Point& p) {
  return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
}

/// Length of crease edges.
template <class Triangulation>
class MeteredEdges : public CGAL::Mesh_edge_criteria_3<Triangulation> {
  using Base = CGAL::Mesh_edge_criteria_3<Triangulation>;

 public:
  MeteredEdges(double size, Meter& meter) : Base(size), meter_(&meter) {}
  typename Base::FT sizing_field(const typename Base::Point_3& p, int dimension,
                                 const typename Base::Index& index) const {
    meter_->judged(0, position(p));
    return Base::sizing_field(p, dimension, index);
  }

 private:
  Meter* meter_;
};

/// Exception: facets shrink without end at a place.
struct Runaway {
  Vec3 place;
  double size;  ///< [m]
};

/// Accepts a facet whose vertices are nearer than `least` [m] to its surface centre.  Throws Runaway after
/// more than kVanished facets with vertices nearer than `vanishing` [m].
template <class Triangulation>
class MeteredFacets : public CGAL::Mesh_facet_criteria_3<Triangulation> {
  using Base = CGAL::Mesh_facet_criteria_3<Triangulation>;

 public:
  MeteredFacets(const Base& criteria, double least, double vanishing, Meter& meter)
      : Base(criteria), least_(least), vanishing_(vanishing), meter_(&meter) {}
  typename Base::Is_facet_bad operator()(const Triangulation& all,
                                         const typename Triangulation::Facet& facet) const {
    const auto& corner = facet.first->vertex((facet.second + 1) & 3)->point().point();
    meter_->judged(all.number_of_vertices(), position(corner));
    const double radius =
        std::sqrt(CGAL::squared_distance(facet.first->get_facet_surface_center(facet.second), corner));
    if (radius < vanishing_ && ++vanished_ > kVanished) throw Runaway{position(corner), radius};
    if (radius < least_) return {};
    return Base::operator()(all, facet);
  }

 private:
  /// Number of vanishing facets that is tolerated.
  static constexpr int kVanished = 200;
  double least_, vanishing_;
  Meter* meter_;
  mutable int vanished_ = 0;  ///< count of this copy
};

/// Accepts a cell whose longest edge is below `least` [m].
template <class Triangulation>
class MeteredCells : public CGAL::Mesh_cell_criteria_3<Triangulation> {
  using Base = CGAL::Mesh_cell_criteria_3<Triangulation>;

 public:
  MeteredCells(const Base& criteria, double least, Meter& meter)
      : Base(criteria), least_(least), meter_(&meter) {}
  typename Base::Is_cell_bad operator()(const Triangulation& all,
                                        const typename Triangulation::Cell_handle& cell) const {
    meter_->judged(all.number_of_vertices(), position(cell->vertex(0)->point().point()));
    if (least_ > 0 && longest(*cell) < least_) return {};
    return Base::operator()(all, cell);
  }

 private:
  template <class Cell>
  static double longest(const Cell& cell) {
    double out = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j)
        out = std::max(
            out,
            (position(cell.vertex(i)->point().point()) - position(cell.vertex(j)->point().point())).norm());
    return out;
  }

  double least_;
  Meter* meter_;
};

template <class Triangulation>
/// Criteria of refinement for Mesher.
using MeteredCriteria = CGAL::Mesh_criteria_3<Triangulation, MeteredEdges<Triangulation>,
                                              MeteredFacets<Triangulation>, MeteredCells<Triangulation>>;

}  // namespace palpate::model
