#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "mesh/provenance.h"
#include "palpate/core/error.h"
#include "palpate/core/types.h"

/// Checks common to tetrahedra and triangles.  Elements: Corners x n, one per column.
namespace palpate::mesh {

/// Rejects coordinates that are not finite or exceed 1e30 m.
inline void refuse_non_finite(const Points& points, const Provenance& from) {
  constexpr double kLargest = 1e30;  // [m]; a volume beyond it overflows
  for (int i = 0; i < static_cast<int>(points.cols()); ++i)
    for (int k = 0; k < 3; ++k)
      if (const double x = points(k, i); !(std::abs(x) <= kLargest))
        fail("{}: {} = {} is not a finite length within 1e30 m; write the mesh again", from.node(i), "xyz"[k],
             x);
}

/// Rejects elements with a repeated corner.
template <int Corners>
void refuse_repeated_nodes(const Eigen::Matrix<int, Corners, Eigen::Dynamic>& elements,
                           const Provenance& from) {
  for (int e = 0; e < static_cast<int>(elements.cols()); ++e)
    for (int i = 0; i < Corners; ++i)
      for (int j = 0; j < i; ++j)
        if (elements(i, e) == elements(j, e))
          fail("{} is degenerate: it has {} twice; remove it or mesh again", from.element(e),
               from.node_name(elements(i, e)));
}

/// Rejects elements with the same corners as another.
template <int Corners>
void refuse_duplicates(const Eigen::Matrix<int, Corners, Eigen::Dynamic>& elements, const Provenance& from) {
  std::vector<std::pair<std::array<int, static_cast<std::size_t>(Corners)>, int>> sets;
  sets.reserve(static_cast<std::size_t>(elements.cols()));
  for (int e = 0; e < static_cast<int>(elements.cols()); ++e) {
    std::array<int, static_cast<std::size_t>(Corners)> nodes;
    for (int i = 0; i < Corners; ++i) nodes[static_cast<std::size_t>(i)] = elements(i, e);
    std::sort(nodes.begin(), nodes.end());
    sets.emplace_back(nodes, e);
  }
  std::sort(sets.begin(), sets.end());
  for (std::size_t i = 1; i < sets.size(); ++i)
    if (sets[i - 1].first == sets[i].first)
      fail("{} has the same corners as {}; remove one of the two", from.element(sets[i].second),
           from.element(sets[i - 1].second));
}

/// Rejects points of no element; `remedy` completes the message.
template <int Corners>
void refuse_unreferenced(Eigen::Index points, const Eigen::Matrix<int, Corners, Eigen::Dynamic>& elements,
                         const Provenance& from, std::string_view remedy) {
  std::vector<char> used(static_cast<std::size_t>(points), 0);
  for (Eigen::Index i = 0; i < elements.size(); ++i) used[static_cast<std::size_t>(elements.data()[i])] = 1;
  const auto unused = std::count(used.begin(), used.end(), 0);
  if (unused == 0) return;
  const auto first = static_cast<int>(std::find(used.begin(), used.end(), 0) - used.begin());
  fail("{} (one of {}) {}", from.node(first), unused, remedy);
}

}  // namespace palpate::mesh
