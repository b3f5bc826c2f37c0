#include "contact/region_parts.h"

#include <algorithm>
#include <utility>

namespace palpate::contact {

void RegionParts::find_planes() {
  const auto key = [](const PairOverlap& overlap) { return std::pair(overlap.a, overlap.b); };
  std::sort(overlaps_.begin(), overlaps_.end(),
            [&](const PairOverlap& x, const PairOverlap& y) { return key(x) < key(y); });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < overlaps_.size(); ++i) {
    if (kept > 0 && key(overlaps_[kept - 1]) == key(overlaps_[i])) {
      overlaps_[kept - 1].push += overlaps_[i].push;
      overlaps_[kept - 1].volume += overlaps_[i].volume;
    } else {
      overlaps_[kept++] = overlaps_[i];
    }
  }
  overlaps_.resize(kept);
  units_ = planes_.find(
      overlaps_, [&](int p, int q) { return a_.neighbours(p, q); },
      [&](int p, int q) { return b_.neighbours(p, q); });
}

RegionPart& RegionParts::part_along(const Vec3& normal) {
  for (std::size_t i = 0; i < count_; ++i)
    if ((parts_[i].first - normal).norm() <= kOnePlane) return parts_[i];
  if (parts_.size() == count_) parts_.emplace_back();
  RegionPart& part = parts_[count_++];
  part.first = normal;
  part.force.setZero();
  part.volume = 0.0;
  part.proxies.clear();
  return part;
}

std::span<const RegionPart> RegionParts::of(std::span<const PairOverlap> overlaps) {
  count_ = 0;
  for (const PairOverlap& overlap : overlaps) {
    const auto unit = std::lower_bound(units_.begin(), units_.end(), overlap.a,
                                       [](const PlaneUnit& u, int proxy) { return u.proxy < proxy; });
    RegionPart& part = part_along(unit->normal);
    part.force += overlap.volume * unit->normal;
    part.volume += overlap.volume;
    part.proxies.push_back(overlap.a);
  }
  std::sort(parts_.begin(), parts_.begin() + static_cast<std::ptrdiff_t>(count_),
            [](const RegionPart& x, const RegionPart& y) { return x.volume > y.volume; });
  return {parts_.data(), count_};
}

}  // namespace palpate::contact
