#pragma once
#include <optional>

#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// Returns the angle [degrees] above which edges are kept as creases, or nothing if the surface has none.
///
/// Machined parts and grown shapes both have sharp edges.  The creases of a part form lines that close, or
/// end where other creases meet; the sharp edges of a scan or a sculpture are isolated, or short pieces with
/// loose ends.  So edges that turn by more than 50 degrees are creases if their total length is at least half
/// the diagonal of the bounding box and at most one in twenty of their vertices is a loose end.
/// @param surface  closed
std::optional<double> crease_angle(const TriMesh& surface);

}  // namespace palpate::model
