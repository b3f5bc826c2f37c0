#include "memory_question.h"

#include <fmt/format.h>

#include <cmath>

#include "core/memory.h"

namespace palpate::cli {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

/// Returns the volume enclosed by a closed surface, a sixth of the sum of the triple products of its
/// triangles [m^3].
double volume_of(const TriMesh& surface) {
  double sum = 0.0;
  for (Eigen::Index f = 0; f < surface.faces.cols(); ++f) {
    const auto corner = [&](int k) { return Vec3(surface.vertices.col(surface.faces(k, f))); };
    sum += corner(0).dot(corner(1).cross(corner(2)));
  }
  return std::abs(sum) / 6.0;
}

/// Returns the requested number of tetrahedra: a regular one of edge h has the volume h^3 / (6 sqrt 2).
double wanted_tetrahedra(const ModelArguments& arguments, const model::Input& input) {
  if (input.tets.tets.cols() > 0 && !arguments.options.remesh)
    return static_cast<double>(input.tets.tets.cols());
  const model::TetrahedraOptions& requested = arguments.options.tetrahedra;
  if (requested.element_size_m <= 0.0) return requested.tetrahedra;
  const double edge = requested.element_size_m / arguments.options.scale;
  return volume_of(input.surface) * 6.0 * std::sqrt(2.0) / std::pow(edge, 3);
}

}  // namespace

// Measured peaks: 49 MiB for the pumpkin of 30,000 vertices with 10,000 tetrahedra, 102 MiB with 150,000; 56
// MiB for the head of 44,000 vertices with 40,000 tetrahedra.
void refuse_beyond_memory(const ModelArguments& arguments, const model::Input& input) {
  constexpr double kProgram = 25.0 * kMiB, kVertex = 800.0, kTetrahedron = 400.0;
  const double tetrahedra = wanted_tetrahedra(arguments, input),
               vertices = static_cast<double>(input.surface.vertices.cols() + input.skin.vertices.cols());
  palpate::refuse_beyond_memory(fmt::format("{}: {:.3g} tetrahedra in a surface of {:.0f} vertices",
                                            input.source, tetrahedra, vertices),
                                kProgram + kVertex * vertices + kTetrahedron * tetrahedra, "",
                                "fewer --tetrahedra need less");
}

}  // namespace palpate::cli
