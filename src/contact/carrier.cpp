#include "contact/carrier.h"

namespace palpate::contact {

SurfacePoint point_of(const Carrier& carrier, const Vec3& from_carrier, const Vec3& normal) {
  SurfacePoint out;
  const Vec4 place = from_carrier.homogeneous();
  const Vec4 rows = carrier.by_place * place;
  out.frame = carrier.frame;
  if (carrier.frame >= 0) {
    out.offset = rows.head<3>();
    return out;
  }
  out.count = carrier.count;
  out.node = carrier.node;
  for (std::size_t i = 0; i < 4; ++i) out.weight[i] = rows[static_cast<Eigen::Index>(i)];
  out.offset = carrier.beside.dot(place) * normal;
  return out;
}

}  // namespace palpate::contact
