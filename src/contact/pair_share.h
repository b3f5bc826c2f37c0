#pragma once
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contact/region_parts.h"

namespace palpate::contact {

/// Which pairs of proxies a part of a region sees.  A proxy of a that pushes along several normals is in
/// several parts, and each of its pairs is in one: the part that it was counted in, and where it did not
/// press, in the first part that the proxy is in, or the first of all.
class PairShare {
 public:
  void take_all();  ///< of a region that has no parts
  /// @param whole  what is divided; may be this one
  void take_part(const PairShare& whole, std::span<const RegionPart> parts, std::size_t part);

  bool all() const { return others_.empty() && foreign_.empty(); }
  bool has(int a, int b) const;
  /// Whether a part has pairs of a's proxy.
  static bool has_proxy(std::span<const RegionPart> parts, std::size_t part, int a);

 private:
  using Pairs = std::vector<std::pair<int, int>>;
  std::vector<int> foreign_, next_foreign_;  // proxies of a, ascending, of which it has `mine_` alone
  Pairs mine_, next_mine_;                   // ascending
  Pairs others_, next_others_;               // ascending, of all others what it has not
};

}  // namespace palpate::contact
