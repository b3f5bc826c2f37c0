#include <CGAL/Side_of_triangle_mesh.h>

#include "cgal_surface.h"
#include "model/regions.h"

namespace palpate::model {

std::vector<char> inside_of(const TriMesh& surface, const Points& points) {
  const mesh::Provenance from;
  const Soup soup = soup_of(surface, from);
  return guarded(soup, [&] {
    const CgalSurface mesh = cgal_of(soup);
    const CGAL::Side_of_triangle_mesh<CgalSurface, Kernel> side(mesh);
    std::vector<char> out;
    for (const auto& p : points.colwise())
      out.push_back(side(Kernel::Point_3(p.x(), p.y(), p.z())) != CGAL::ON_UNBOUNDED_SIDE);
    return out;
  });
}

}  // namespace palpate::model
