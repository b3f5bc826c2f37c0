#pragma once
#include <optional>
#include <vector>

#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// Intersection query on the surface that is meshed.
class SurfaceQuery {
 public:
  virtual ~SurfaceQuery() = default;
  /// Returns the point where the segment from a to b meets the surface [m], if any.
  virtual std::optional<Vec3> crossing(const Vec3& a, const Vec3& b) const = 0;
};

/// Mesh whose boundary can be fitted.
struct FittedMesh {
  TetMesh mesh;
  std::vector<char> on_crease;  ///< per node: nonzero for nodes that must not move
};

/// Moves boundary nodes along their normals so that the boundary approximates the surface on both sides
/// instead of inscribing it.
/// @param cell_size  sets the search distance for the surface [m]
/// @param volume     volume of the inside [m^3]: the movement is scaled to meet it; nothing: unscaled
void fit_volume(FittedMesh& mesh, const SurfaceQuery& surface, double cell_size,
                std::optional<double> volume);

}  // namespace palpate::model
