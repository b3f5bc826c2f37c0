#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::fem {

/// Derivative of the elastic force with respect to position that implicit methods use: kExact, the exact one;
/// kProjected, its nearest positive semi-definite matrix, element by element; kWarped, for laws that support
/// it, the stiffness at rest rotated with each element (Mueller and Gross 2004).
enum class Tangent { kExact, kProjected, kWarped };
/// Returns the names of the values.
constexpr std::array<std::string_view, 3> option_names(Tangent) { return {"exact", "projected", "warped"}; }

/// Options for the evaluation of a body's force and its derivatives.
struct SoftBodyOptions {
  Tangent tangent = Tangent::kExact;  ///< derivative of the elastic force
  bool full_damping_tangent = false;  ///< include the unsymmetric damping derivative by position
  /// Share of lambda (and of lambda_d) that acts element by element; the rest belongs to a NodalDilatation.
  double volumetric_share = 1.0;
  /// Instruction set: "baseline", "avx2" or "avx512". Empty: the value of the environment variable
  /// PALPATE_INSTRUCTIONS, else the widest set of the processor.
  std::string instructions = {};
  /// Share of each material where they differ; empty: volumetric_share for all.
  std::vector<double> volumetric_shares = {};
  /// Constitutive law, a name in law_registry() (laws.h).
  std::string law = "corotational";

  /// Returns the share of lambda that the elements of a material keep.
  double share_of(std::size_t material) const {
    return volumetric_shares.empty() ? volumetric_share : volumetric_shares[material];
  }
};

}  // namespace palpate::fem
