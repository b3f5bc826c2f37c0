#pragma once
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::loop {

struct MeshCounts {
  int nodes = 0, tetrahedra = 0;
};

/// About what a run takes at its peak [bytes], from counts alone.
struct MemoryEstimate {
  double program = 0.0;   ///< code, libraries, tables
  double elements = 0.0;  ///< meshes, elements, the step's matrix, vectors
  double factor = 0.0;    ///< of a direct solver
  double total() const { return program + elements + factor; }
};
/// Measured peaks were 0.8 to 1.4 of it, from 5,000 to 185,000 tetrahedra (tests/cli/bad_input_test.py holds
/// it to a factor of 2); skins, proxies and contact are not counted.
MemoryEstimate estimate_memory(const scene::Description& description, const std::vector<MeshCounts>& bodies);

}  // namespace palpate::loop
