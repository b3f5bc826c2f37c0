#pragma once
// A soup as CGAL's surface mesh and back, with the places in the file kept.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include "cgal_failure.h"
#include "palpate/core/error.h"
#include "soup.h"

namespace palpate::model {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalSurface = CGAL::Surface_mesh<Kernel::Point_3>;

/// @pre faces agree in their turning and every edge has one or two of them
CgalSurface cgal_of(const Soup& soup);
Soup soup_of(CgalSurface& mesh, const mesh::Provenance& from);  ///< collects what was removed first

/// Runs what calls CGAL; what CGAL finds impossible becomes an Error.
template <class Work>
auto guarded(const Soup& soup, Work work) {
  try {
    return work();
  } catch (const CGAL::Failure_exception& e) {
    fail("{}: the surface cannot be mended; CGAL says: {}", soup.from->source, reason_of(e));
  }
}

}  // namespace palpate::model
