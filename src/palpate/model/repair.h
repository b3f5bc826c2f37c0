#pragma once
#include <functional>
#include <string>
#include <vector>

#include "palpate/mesh/checks.h"
#include "palpate/model/progress.h"

namespace palpate::model {

struct RepairOptions {
  double largest_hole = 0.15;  ///< a hole is closed when that adds no more than this share of the surface
  bool largest_shell = false;  ///< several bodies in one file: keep the largest instead of refusing
  bool wrap = true;            ///< what cannot be mended locally is wrapped, and said so
  /// is called where a piece of work begins that may take long; may be empty
  std::function<void(const std::string& where)> place = {};
};

/// A surface that bounds one body: closed, oriented outwards, no face through another; and what had to be
/// done for that.
struct RepairedSurface {
  TriMesh surface;
  std::vector<std::string> notes;  ///< one sentence each; empty: it was sound
};

/// Makes a body's surface of triangles as people have them, in this order, each step counted in a note:
/// vertices at one place become one; collapsed and double faces go; faces are turned to agree; small holes
/// are closed by a smooth patch; needles and flat faces are collapsed; faces that go through each other are
/// cut out and the place is closed anew; shells are sorted: inside another one and turned outwards, it goes
/// (the body is solid there); turned inwards, it stays (a cavity); specks of less than 1e-4 of the volume go.
/// What then still has faces through each other (shells that overlap, a knot) is wrapped: a surface at a
/// 600th of the diagonal around it (Portaneri et al. 2022, alpha wrapping), with the change of volume said.
/// @throws Error with the place (line, vertex or face, and coordinates) for: no closed body (too large a
///   hole), a one-sided surface, several bodies, numbers
/// that are not finite, no volume
RepairedSurface repair(const TriMesh& faces, const mesh::Provenance& from, const RepairOptions& options = {},
                       const Progress& progress = {});

}  // namespace palpate::model
