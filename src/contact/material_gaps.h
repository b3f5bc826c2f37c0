#pragma once
#include <span>
#include <vector>

#include "contact/material_points.h"
#include "palpate/contact/obstacle.h"
#include "palpate/contact/sum_error.h"

namespace palpate::contact {

/// Integrals of the overlap between material points and a shape: as distance::SkinContact's, with the shape's
/// exact gaps, linear on each triangle.  A curvature H that is the same all over the shape is taken into
/// account: a triangle's gaps are lowered by H sum e^2/24, e its edges at rest, so that their mean is right.
class MaterialGaps {
 public:
  /// @param curvature  H [1/m]
  MaterialGaps(const MaterialPoints& points, double curvature);

  double largest_lowering() const { return lowered_.size() ? lowered_.maxCoeff() : 0.0; }  ///< of a gap [m]

  /// Takes the points wanted and all that share a triangle with one of them.
  /// @param wanted  of each point whether it is
  void start(const std::vector<char>& wanted);
  /// The points taken, in their order.
  const std::vector<int>& points() const { return taken_; }

  /// @param at  of each point taken
  void integrate(std::span<const Nearest> at);
  /// Integral of overlap times hat of a point taken, by its place in points() [m^3].
  double overlap(std::size_t i) const { return overlap_[i]; }
  /// Integral of the overlap's square, as far as it is this point's, over overlap(i)^2/area(i).
  double stored(std::size_t i) const { return square_[i] * area_[i] / (overlap_[i] * overlap_[i]); }
  /// Area of its hat where it overlaps; of all of it where it does not [m^2].
  double area(std::size_t i) const { return area_[i]; }
  /// Returns the sum of the last integrate(), its error and its largest term.
  /// @param x, at  positions and gaps of the points taken
  SumError::Query sum_error(std::span<const Vec3> x, std::span<const Nearest> at) const;

 private:
  struct Triangle {
    int number = 0;
    Eigen::Vector3i corner = Eigen::Vector3i::Zero();  ///< places in points()
  };
  template <class Visit>
  void for_each_overlap(std::span<const Nearest> at, const Visit& visit) const;

  Faces triangles_;
  VecX triangle_area_, lowered_;      ///< of each triangle [m^2], [m]
  std::vector<double> hat_;           ///< of each point [m^2]
  std::vector<int> fan_begin_, fan_;  ///< triangles around each point
  std::vector<int> place_;            ///< of each point in taken_; -1: it is not there
  std::vector<char> is_near_;         ///< triangles of near_
  std::vector<int> taken_;
  std::vector<Triangle> near_;
  std::vector<double> overlap_, area_, square_;
};

}  // namespace palpate::contact
