#pragma once
#include <optional>

#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// The angle above which edges are creases to keep, or nothing where the surface has none.
///
/// Machined parts and grown shapes both have edges that turn sharply; what tells them apart is that the
/// creases of a part are lines that go on: they close, or end where other creases meet.  On a scan or a
/// sculpture sharp edges stand alone or in short pieces with loose ends.  So: edges that turn by more than 50
/// degrees are creases when they are long together (half the diagonal of the bounding box at least) and at
/// most one in twenty of their vertices is a loose end.
/// @param surface  closed
std::optional<double> crease_angle(const TriMesh& surface);

}  // namespace palpate::model
