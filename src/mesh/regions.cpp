#include "palpate/mesh/regions.h"

#include <algorithm>
#include <numeric>

#include "palpate/core/error.h"

namespace palpate::mesh {

std::vector<int> by_falling_size(const std::vector<MaterialRegion>& regions) {
  std::vector<int> out(regions.size());
  std::iota(out.begin(), out.end(), 0);
  std::stable_sort(out.begin(), out.end(), [&](int a, int b) {
    return regions[static_cast<std::size_t>(a)].tets.size() >
           regions[static_cast<std::size_t>(b)].tets.size();
  });
  return out;
}

std::vector<int> region_of_element(const std::vector<MaterialRegion>& regions, int tets) {
  std::vector<int> out(static_cast<std::size_t>(tets), -1);
  for (const int r : by_falling_size(regions))
    for (const int tet : regions[static_cast<std::size_t>(r)].tets) {
      PALPATE_CHECK(tet >= 0 && tet < tets, "region \"{}\" refers to element {} of {}",
                    regions[static_cast<std::size_t>(r)].name, tet, tets);
      out[static_cast<std::size_t>(tet)] = r;
    }
  return out;
}

std::vector<MaterialRegion> regions_of_groups(std::map<double, std::vector<int>> groups,
                                              const std::map<double, std::string>& names, std::size_t tets) {
  if (groups.size() == 1 && groups.begin()->second.size() == tets && !names.contains(groups.begin()->first))
    return {};
  std::vector<MaterialRegion> out;
  for (auto& [number, members] : groups) {
    const auto named = names.find(number);
    const std::string name = named != names.end() ? named->second : fmt::format("region-{}", number);
    const auto same = std::find_if(out.begin(), out.end(), [&](const auto& r) { return r.name == name; });
    if (same == out.end()) {
      out.push_back({name, std::move(members)});
      continue;
    }
    std::vector<int> both;
    std::set_union(same->tets.begin(), same->tets.end(), members.begin(), members.end(),
                   std::back_inserter(both));
    same->tets = std::move(both);
  }
  return out;
}

std::vector<MaterialRegion> regions_of_labels(const std::vector<double>& labels,
                                              const std::map<double, std::string>& names,
                                              std::optional<double> none) {
  std::map<double, std::vector<int>> groups;
  for (std::size_t t = 0; t < labels.size(); ++t)
    if (labels[t] != none) groups[labels[t]].push_back(static_cast<int>(t));
  return regions_of_groups(std::move(groups), names, labels.size());
}

}  // namespace palpate::mesh
