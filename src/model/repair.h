#pragma once
#include <functional>
#include <string>
#include <vector>

#include "mesh/provenance.h"
#include "model/progress.h"

namespace palpate::model {

/// Options of `repair`.
struct RepairOptions {
  double largest_hole = 0.15;  ///< holes are closed if that adds no more than this share of the surface's
                               ///< area in total
  bool largest_shell = false;  ///< several bodies in one file: keep the largest instead of failing
  bool wrap = true;            ///< a surface that cannot be mended locally is wrapped, with a note
  /// Is called at the start of an operation that may take long; may be empty.
  std::function<void(const std::string& where)> place = {};
};

/// Surface that bounds one body: closed, oriented outwards, without self-intersections; and the repairs that
/// were made.
struct RepairedSurface {
  TriMesh surface;
  std::vector<std::string> notes;  ///< one sentence per repair; empty: the surface was sound
};

/// Turns a user's triangles into a body's surface.  The steps, each counted in a note: coincident vertices
/// are merged; collapsed and duplicate faces are dropped; faces are oriented consistently; small holes are
/// closed by a smooth patch; needles and flat faces are collapsed; faces that intersect are cut out and the
/// place is closed anew; shells are sorted: one inside another and oriented outwards is dropped (the body is
/// solid there), one oriented inwards is kept (a cavity); specks of less than 1e-4 of the volume are dropped.
/// A surface that still intersects itself (overlapping shells, a knot) is wrapped: a surface at a 1500th of
/// the diagonal around it (Portaneri et al. 2022, alpha wrapping), with the change of volume in a note.
/// @throws Error with the place (line, vertex or face, and coordinates) for: no closed body (too large a
///   hole), a one-sided surface, several bodies, numbers that are not finite, no volume
RepairedSurface repair(const TriMesh& faces, const mesh::Provenance& from, const RepairOptions& options = {},
                       const Progress& progress = {});

}  // namespace palpate::model
