#include "palpate/mesh/regions.h"

#include "palpate/core/error.h"

namespace palpate::mesh {

std::vector<int> region_of_element(const std::vector<MaterialRegion>& regions, int tets) {
  std::vector<int> out(static_cast<std::size_t>(tets), -1);
  for (std::size_t r = 0; r < regions.size(); ++r)
    for (const int tet : regions[r].tets) {
      PALPATE_CHECK(tet >= 0 && tet < tets, "region \"{}\" names element {} of {}", regions[r].name, tet,
                    tets);
      int& region = out[static_cast<std::size_t>(tet)];
      PALPATE_CHECK(region < 0, "element {} is in the regions \"{}\" and \"{}\"", tet,
                    regions[static_cast<std::size_t>(region)].name, regions[r].name);
      region = static_cast<int>(r);
    }
  return out;
}

std::vector<MaterialRegion> regions_of_labels(const std::vector<double>& labels,
                                              const std::map<double, std::string>& names,
                                              std::optional<double> none) {
  std::map<double, std::vector<int>> by_label;
  for (std::size_t t = 0; t < labels.size(); ++t) by_label[labels[t]].push_back(static_cast<int>(t));
  if (by_label.size() == 1 && !names.contains(by_label.begin()->first)) return {};
  std::vector<MaterialRegion> out;
  for (auto& [label, tets] : by_label) {
    if (none && label == *none) continue;
    const auto named = names.find(label);
    out.push_back({named != names.end() ? named->second : fmt::format("region-{}", label), std::move(tets)});
  }
  return out;
}

}  // namespace palpate::mesh
