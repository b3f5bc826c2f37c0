#pragma once
#include <optional>
#include <string>

#include "palpate/core/keys.h"
#include "palpate/core/types.h"

namespace palpate {

/// Source of a body's tetrahedra or a tool's surface: a file, or a generator by name.  Plain data.
struct MeshSpec {
  /// Path relative to the scene file, or "model:NAME" for a model that `palpate model NAME` makes, kept in a
  /// cache (store/model_cache.h); empty: use the generator.
  std::string file;
  std::string generator;              ///< "box", "ball", "cylinder", "tet"
  Vec3 size_m = Vec3::Constant(1.0);  ///< box: edge lengths
  double radius_m = 1.0;              ///< ball, cylinder
  double length_m = 1.0;              ///< cylinder, along z
  double element_size_m = 0.25;       ///< target edge length
  double grading = 1.0;               ///< element size in the middle / at the surface; 1 is uniform
  /// Factor on a file's coordinates; empty: 1, for a file whose size is plausible in metres.
  std::optional<double> scale;

  double factor() const { return scale.value_or(1.0); }  ///< factor on a file's coordinates
  /// Whether the file is a layered model, with skin, proxies and bones, rather than a plain mesh.
  bool has_model() const { return file.ends_with(".h5") || file.starts_with("model:"); }
};

/// Valid ranges: checked by the scene loader, the readers and the generators.
struct MeshRanges {
  static constexpr Range length = Range::open(0.0, 1e6, "lengths are in metres");  ///< [m]
  /// Ratio of element sizes, middle to surface.
  static constexpr Range grading = Range::closed(
      0.5, 32.0, "1 is uniform, 2 makes elements in the middle twice as large as at the surface");
  /// Factor on a file's coordinates.
  static constexpr Range scale = Range::positive("0.001 converts a file in millimetres to metres");
};

}  // namespace palpate
