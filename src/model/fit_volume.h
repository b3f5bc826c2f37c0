#pragma once
#include <optional>
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// Answers where a short line meets the surface that is meshed.
class SurfaceQuery {
 public:
  virtual ~SurfaceQuery() = default;
  virtual std::optional<Vec3> crossing(const Vec3& a, const Vec3& b) const = 0;
};

struct FittedMesh {
  TetMesh mesh;
  std::vector<char> on_crease;  ///< nodes that stay where they are
};

/// Moves boundary nodes along their normals so that the boundary runs through the surface instead of inside
/// it.
/// @param cell_size  sets how far the surface is looked for [m]
/// @param volume  of the inside [m^3]: the movement is scaled to meet it; nothing: it is made as it comes
void fit_volume(FittedMesh& mesh, const SurfaceQuery& surface, double cell_size,
                std::optional<double> volume);

}  // namespace palpate::model
