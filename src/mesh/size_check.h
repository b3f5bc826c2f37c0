#pragma once
#include <optional>

#include "palpate/core/types.h"

namespace palpate::mesh {

/// Size that is implausible for a body or tool in metres.
struct SizeDoubt {
  double size_m;           ///< largest extent along an axis [m]
  const char* other_unit;  ///< likely unit of the file: "millimetres", or "kilometres"
  double factor;           ///< factor from that unit to metres
};

/// Returns nothing if the extent lies between 1 mm and 10 m, or is not finite.
inline std::optional<SizeDoubt> doubt_about_size(const Points& points) {
  constexpr double kLargest = 10.0, kSmallest = 1e-3;  // [m]
  if (points.cols() == 0 || !points.allFinite()) return std::nullopt;
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  if (size > kLargest) return SizeDoubt{size, "millimetres", 1e-3};
  if (size < kSmallest) return SizeDoubt{size, "kilometres", 1e3};
  return std::nullopt;
}

}  // namespace palpate::mesh
