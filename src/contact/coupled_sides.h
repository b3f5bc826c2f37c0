#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "contact/coupled_nodes.h"
#include "contact/image_side.h"

namespace palpate::contact {

/// Node pairs that the samples of two sides may couple: those of the faces of each soft side and, between two
/// soft sides, those of the samples (CoupledNodes).
class CoupledSides {
 public:
  /// @param a, b  must outlive this object; the same side twice: self-contact
  CoupledSides(const ImageSide& a, const ImageSide& b) : a_(a), b_(b) {}
  CoupledSides(const CoupledSides&) = delete;
  CoupledSides& operator=(const CoupledSides&) = delete;
  /// Returns whether both sides are soft, so that the tangent has blocks between their nodes.
  bool are_soft() const { return a_.soft() && b_.soft(); }
  /// Records the joints of a query. @pre both sides are soft
  void take(std::span<const CoupledNodes::Joint> joints);
  void add_pattern(dynamics::PatternBuilder& pattern) const;  ///< As SampleSource::add_pattern().
  std::uint64_t version() const;                              ///< As SampleSource::pattern_version().

 private:
  std::uint64_t sides_version() const;  ///< Increases with the pairs that either side couples alone.

  const ImageSide &a_, &b_;
  mutable CoupledNodes coupled_;  ///< The pattern is built on request.
  std::array<NodeNeighbours, 2> neighbours_;
  std::uint64_t counted_ = 0;  ///< Value of sides_version() for which `coupled_` was made.
};

}  // namespace palpate::contact
