#include "contact/sample_cells.h"

#include <algorithm>

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

void SampleCells::clear() {
  carriers.clear();
  cells.clear();
  places.clear();
  areas.clear();
}

std::size_t SampleCells::bytes() const {
  return carriers.size() * sizeof(Carrier) + cells.size() * sizeof(ContactCell) +
         places.size() * sizeof(SamplePlace) + areas.size() * sizeof(double);
}

ContactSample SampleCells::sample(const ContactCell& cell, int place) const {
  const SamplePlace& at = places[static_cast<std::size_t>(place)];
  const Carrier &a = carriers[static_cast<std::size_t>(cell.a)],
                &b = carriers[static_cast<std::size_t>(cell.b)];
  ContactSample out;
  out.a = point_of(a, Vec3(at.u, at.v, at.w_a), cell.normal);
  out.b = point_of(b, Vec3(at.u, at.v, at.w_b) + a.at - b.at, cell.normal);
  out.normal = cell.normal;
  out.area = area(cell, place);
  out.gap = at.w_a - at.w_b;
  out.source = cell.pair;
  return out;
}

bool SampleCells::have_points_of(const SampleCells& other) const {
  const auto is_same = [](const Carrier& p, const Carrier& q) {
    return p.frame == q.frame && p.count == q.count && (p.frame >= 0 || p.node == q.node);
  };
  return std::equal(cells.begin(), cells.end(), other.cells.begin(), other.cells.end(),
                    [&](const ContactCell& s, const ContactCell& t) {
                      const auto of = [](const SampleCells& all, int carrier) -> const Carrier& {
                        return all.carriers[static_cast<std::size_t>(carrier)];
                      };
                      return s.pair == t.pair && s.first == t.first && s.last == t.last &&
                             is_same(of(*this, s.a), of(other, t.a)) &&
                             is_same(of(*this, s.b), of(other, t.b));
                    });
}

void SampleCells::append_to(std::vector<ContactSample>& samples, std::size_t first_cell,
                            std::size_t last_cell) const {
  for (std::size_t c = first_cell; c < last_cell; ++c)
    for (int i = cells[c].first; i < cells[c].last; ++i) samples.push_back(sample(cells[c], i));
}

}  // namespace palpate::contact
