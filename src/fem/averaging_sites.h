#pragma once
#include <array>
#include <vector>

#include "palpate/fem/material.h"
#include "rest_elements.h"

namespace palpate::fem {

/// Sites at which NodalDilatation takes averages: each node, once for each material at it.  With one material
/// the sites are the nodes, and nothing is stored.
struct AveragingSites {
  std::array<std::vector<int>, 4> corner;  ///< site of each corner of each element
  std::vector<double> volume;              ///< [m^3]
  std::vector<int> node, material;         ///< of each site

  AveragingSites(const RestElements& elements, const Materials& materials);
  const std::array<std::vector<int>, 4>& of_corner(const RestElements& elements) const {
    return node.empty() ? elements.node : corner;
  }
  double volume_of(const RestElements& elements, int site) const {
    return (node.empty() ? elements.nodal_volume : volume)[static_cast<std::size_t>(site)];
  }
  int count(const RestElements& elements) const {
    return node.empty() ? elements.node_count() : static_cast<int>(node.size());
  }
  int node_of(int site) const { return node.empty() ? site : node[static_cast<std::size_t>(site)]; }
};

}  // namespace palpate::fem
