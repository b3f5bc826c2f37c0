#include "contact/pair_share.h"

#include <algorithm>

namespace palpate::contact {
namespace {

bool lists(const RegionPart& part, int a) {
  return std::any_of(part.pairs.begin(), part.pairs.end(), [a](const auto& pair) { return pair.first == a; });
}

/// The part that has a proxy's pairs that no part lists.
std::size_t home(std::span<const RegionPart> parts, int a) {
  const auto found = std::find_if(parts.begin(), parts.end(), [a](const RegionPart& p) { return lists(p, a); });
  return found == parts.end() ? 0 : static_cast<std::size_t>(found - parts.begin());
}

template <class List>
void sort_once(List& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

void PairShare::take_all() {
  foreign_.clear();
  mine_.clear();
  others_.clear();
}

bool PairShare::has_proxy(std::span<const RegionPart> parts, std::size_t part, int a) {
  return home(parts, a) == part || lists(parts[part], a);
}

bool PairShare::has(int a, int b) const {
  const std::pair pair(a, b);
  if (std::binary_search(others_.begin(), others_.end(), pair)) return false;
  return !std::binary_search(foreign_.begin(), foreign_.end(), a) ||
         std::binary_search(mine_.begin(), mine_.end(), pair);
}

void PairShare::take_part(const PairShare& whole, std::span<const RegionPart> parts, std::size_t part) {
  next_foreign_.assign(whole.foreign_.begin(), whole.foreign_.end());
  next_mine_ = parts[part].pairs;
  next_others_.assign(whole.others_.begin(), whole.others_.end());
  for (const auto& [a, b] : parts[part].pairs)
    if (home(parts, a) != part) next_foreign_.push_back(a);
  for (const auto& pair : whole.mine_)
    if (home(parts, pair.first) == part) next_mine_.push_back(pair);
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (i != part) next_others_.insert(next_others_.end(), parts[i].pairs.begin(), parts[i].pairs.end());
  sort_once(next_foreign_);
  sort_once(next_mine_);
  sort_once(next_others_);
  foreign_.swap(next_foreign_);
  mine_.swap(next_mine_);
  others_.swap(next_others_);
}

}  // namespace palpate::contact
