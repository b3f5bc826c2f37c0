#include "averaging_sites.h"

#include <map>
#include <utility>

namespace palpate::fem {

AveragingSites::AveragingSites(const RestElements& elements, const Materials& materials) {
  if (materials.of_element.empty()) return;
  std::map<std::pair<int, int>, int> number;  // ordered by node: sites of one node are adjacent
  for (std::size_t e = 0; e < elements.volume.size(); ++e)
    for (const auto& nodes : elements.node) number[{nodes[e], materials.number(e)}] = 0;
  for (auto& [key, site] : number) {
    site = static_cast<int>(node.size());
    node.push_back(key.first);
    material.push_back(key.second);
  }
  volume.assign(node.size(), 0.0);
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t e = 0; e < elements.volume.size(); ++e) {
      corner[a].push_back(number[{elements.node[a][e], materials.number(e)}]);
      volume[static_cast<std::size_t>(corner[a].back())] += 0.25 * elements.volume[e];
    }
}

}  // namespace palpate::fem
