#pragma once
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::loop {

struct Body;

/// Mesh size of one body.
struct MeshCounts {
  int nodes = 0, tetrahedra = 0, skin_vertices = 0;
};
/// Returns the mesh size of an assembled body.
MeshCounts counts_of(const Body& body);

/// Estimated peak memory of a run [bytes], from counts alone.
struct MemoryEstimate {
  double program = 0.0;   ///< Code, libraries, tables.
  double elements = 0.0;  ///< Meshes, elements, the step's matrix, vectors.
  double touch = 0.0;     ///< Separate matrix and solver for a tool that is exchanged at points.
  double skins = 0.0;     ///< Including embedding, proxies and contact points.
  double factor = 0.0;    ///< Factor of a direct solver.
  /// Address space that libraries reserve but hardly use, in addition: the buffer of the BLAS if a
  /// factorisation is done, and stacks of threads. Only limits on address space and data (ulimit -v, -d)
  /// include it.
  double addresses = 0.0;
  double total() const { return program + elements + touch + skins + factor; }
};
/// Estimates the peak memory. Measured peaks were 0.8 to 1.4 of the estimate from 5,000 to 185,000 tetrahedra
/// (tests/cli/bad_input_test.py checks a factor of 2), and with skins 0.8 to 1.3 up to a million vertices.
MemoryEstimate estimate_memory(const scene::Description& description, const std::vector<MeshCounts>& bodies);

}  // namespace palpate::loop
