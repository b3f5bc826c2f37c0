#pragma once
#include <span>
#include <vector>

#include "contact/material_points.h"
#include "palpate/contact/obstacle.h"
#include "palpate/contact/sum_error.h"

namespace palpate::contact {

/// Integrals of the overlap between material points and a shape, as in distance::SkinContact, with the
/// shape's exact gaps, linear on each triangle. A uniform curvature H of the shape is taken into account: a
/// triangle's gaps are lowered by H sum e^2/24, with e its edges at rest, so that their mean is correct.
class MaterialGaps {
 public:
  /// @param curvature  H of the shape [1/m]
  MaterialGaps(const MaterialPoints& points, double curvature);

  /// Largest lowering of a gap [m].
  double largest_lowering() const { return lowered_.size() ? lowered_.maxCoeff() : 0.0; }

  /// Selects the requested points and all points that share a triangle with one of them.
  /// @param requested  per point, whether it is requested
  void start(const std::vector<char>& requested);
  /// Returns the selected points, ascending.
  const std::vector<int>& points() const { return taken_; }

  /// Computes the integrals. @param at  nearest point of the shape, per selected point
  void integrate(std::span<const Nearest> at);
  /// Returns the integral of overlap times hat of a selected point, by its index in points() [m^3].
  double overlap(std::size_t i) const { return overlap_[i]; }
  /// Returns the point's part of the integral of the squared overlap, divided by overlap(i)^2/area(i).
  double stored(std::size_t i) const { return square_[i] * area_[i] / (overlap_[i] * overlap_[i]); }
  /// Returns the integral of the point's hat over the overlapping area; over its whole support where nothing
  /// overlaps [m^2].
  double area(std::size_t i) const { return area_[i]; }
  /// Returns the sum of the last integrate(), its error and its largest term.
  /// @param x, at  positions and nearest points of the selected points
  SumError::Query sum_error(std::span<const Vec3> x, std::span<const Nearest> at) const;

 private:
  struct Triangle {
    int number = 0;
    Eigen::Vector3i corner = Eigen::Vector3i::Zero();  ///< Indices into points().
  };
  template <class Visit>
  void for_each_overlap(std::span<const Nearest> at, const Visit& visit) const;

  Faces triangles_;
  VecX triangle_area_, lowered_;      ///< Area and lowering per triangle [m^2, m].
  std::vector<double> hat_;           ///< Integral of the hat per point [m^2].
  std::vector<int> fan_begin_, fan_;  ///< Triangles around each point (offsets and indices).
  std::vector<int> place_;            ///< Index of each point in taken_; -1: not selected.
  std::vector<char> is_near_;         ///< Marks the triangles of near_.
  std::vector<int> taken_;
  std::vector<Triangle> near_;
  std::vector<double> overlap_, area_, square_;
};

}  // namespace palpate::contact
