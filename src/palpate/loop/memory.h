#pragma once
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::loop {

struct Body;

struct MeshCounts {
  int nodes = 0, tetrahedra = 0, skin_vertices = 0;
};
MeshCounts counts_of(const Body& body);

/// About what a run takes at its peak [bytes], from counts alone.
struct MemoryEstimate {
  double program = 0.0;   ///< code, libraries, tables
  double elements = 0.0;  ///< meshes, elements, the step's matrix, vectors
  double touch = 0.0;     ///< what a tool that is exchanged at points asks for: matrix and solver of its own
  double skins = 0.0;     ///< with their embedding, proxies and contact points
  double factor = 0.0;    ///< of a direct solver
  /// What libraries take of addresses and hardly fill, beside all of it: the buffer of the BLAS where
  /// something is factored, stacks of threads.  Only limits of addresses and of data (ulimit -v, -d) count
  /// it.
  double addresses = 0.0;
  double total() const { return program + elements + touch + skins + factor; }
};
/// Measured peaks were 0.8 to 1.4 of it, from 5,000 to 185,000 tetrahedra (tests/cli/bad_input_test.py holds
/// it to a factor of 2), with skins 0.8 to 1.3 up to a million vertices.
MemoryEstimate estimate_memory(const scene::Description& description, const std::vector<MeshCounts>& bodies);

}  // namespace palpate::loop
