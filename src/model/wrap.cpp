#include "wrap.h"

#include <CGAL/alpha_wrap_3.h>

#include "cgal_surface.h"

namespace palpate::model {

Soup wrapped(const Soup& soup, double alpha, double offset) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> faces;
  for (const Vec3& v : soup.vertices) points.emplace_back(v.x(), v.y(), v.z());
  for (const auto& f : soup.faces)
    faces.push_back(
        {static_cast<std::size_t>(f[0]), static_cast<std::size_t>(f[1]), static_cast<std::size_t>(f[2])});
  return guarded(soup, [&] {
    CgalSurface wrap;
    CGAL::alpha_wrap_3(points, faces, alpha, offset, wrap);
    return soup_of(wrap, *soup.from);
  });
}

}  // namespace palpate::model
