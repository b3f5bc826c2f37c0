#include "store/part_surface.h"

#include <numeric>

#include "palpate/mesh/boundary.h"

namespace palpate::store {

PartSurface part_surface(const RunPart& part) {
  if (part.tets.cols() > 0) {
    mesh::Boundary found = mesh::boundary({part.reference, part.tets});
    return {std::move(found.node_of_vertex), std::move(found.surface.faces)};
  }
  PartSurface out{std::vector<int>(static_cast<std::size_t>(part.reference.cols())), part.faces};
  std::iota(out.node_of_vertex.begin(), out.node_of_vertex.end(), 0);
  return out;
}

}  // namespace palpate::store
