#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace palpate::fem {

/// Which derivative of the elastic force by position implicit methods take: the exact one; its nearest
/// positive semi-definite matrix, element by element; or, of laws that have it, the stiffness at rest,
/// rotated with each element (Mueller and Gross 2004).
enum class Tangent { kExact, kProjected, kWarped };

/// How a body's force and its derivatives are evaluated.
struct SoftBodyOptions {
  Tangent tangent = Tangent::kExact;  ///< derivative of the elastic force
  bool full_damping_tangent = false;  ///< keep the unsymmetric part of the damping's derivative by position
  /// share of lambda (and of lambda_d) that acts element by element; the rest belongs to a NodalDilatation
  double volumetric_share = 1.0;
  /// "baseline", "avx2" or "avx512"; empty: the widest that the processor has, or what the environment
  /// variable PALPATE_INSTRUCTIONS names.
  std::string instructions = {};
  /// the share of each material, where they differ; empty: volumetric_share of all
  std::vector<double> volumetric_shares = {};
  /// constitutive law, a name of law_registry() (laws.h)
  std::string law = "corotational";

  /// The share of lambda that the elements of a material keep.
  double share_of(std::size_t material) const {
    return volumetric_shares.empty() ? volumetric_share : volumetric_shares[material];
  }
};

}  // namespace palpate::fem
