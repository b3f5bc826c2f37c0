#pragma once
// Conversion of a soup to CGAL's surface mesh and back, with the places in the file kept.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include "cgal_failure.h"
#include "palpate/core/error.h"
#include "soup.h"

namespace palpate::model {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
/// CGAL's surface mesh; the places in the file are the properties "v:source" and "f:source".
using CgalSurface = CGAL::Surface_mesh<Kernel::Point_3>;

/// Builds CGAL's mesh of a soup.
/// @pre faces are oriented consistently, and every edge has one or two of them
CgalSurface cgal_of(const Soup& soup);
Soup soup_of(CgalSurface& mesh, const mesh::Provenance& from);  ///< collects removed elements first

/// Runs work that calls CGAL; converts CGAL's failures to Error.
template <class Work>
auto guarded(const Soup& soup, Work work) {
  try {
    return work();
  } catch (const CGAL::Failure_exception& e) {
    fail("{}: the surface cannot be repaired; CGAL reports: {}", soup.from->source, reason_of(e));
  }
}

}  // namespace palpate::model
