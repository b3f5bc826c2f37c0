#pragma once
#include <vector>

#include "contact/reduced_contact_model.h"
#include "coupled_tool.h"

/// Equations of the bodies in the span of their responses to a tool, and their modes (model_reduction.cpp).
namespace palpate::loop {

/// Returns y = (k K + d D) x for all forces, in directions of nodes and bones.
VecX tangent_times(dynamics::System& system, const dynamics::StateView& state, double k, double d,
                   const VecX& x);

/// Contribution of the samples to the reduced system in X.
struct SampleSums {
  MatX K, D;
  VecX force;  ///< Force of the samples on the bodies.
  VecX stiff;  ///< K v + D w/H
};
/// Sums the contribution of the pressing samples.
/// @param X, mean_change  rows of the samples' nodes only
SampleSums sum_of(const std::vector<contact::ReducedSample>& samples,
                  const std::vector<contact::ReducedTangent>& tangents, const MatX& X,
                  const VecX& mean_change);

/// M, K and D in X, without the samples.
struct ReducedSystem {
  MatX M, K, D;
};
/// Reduces the system to an exact X.
/// @param scratch  as large as X
ReducedSystem reduce_exactly(const CoupledTool& tool, const MatX& X, const SampleSums& samples,
                             MatX& scratch);
/// Reduces the system to an X that is not exact: K and D follow from the work.
/// @param H  period [s]  @param work  X^T A X  @param others  whether the bodies have contacts without the
/// tool
/// @param a, b  damping coefficients, D = a M + b K [1/s, s]  @param scratch  as large as X
ReducedSystem reduce_by_work(const CoupledTool& tool, double H, const MatX& X, const MatX& work,
                             const SampleSums& samples, bool others, double a, double b, MatX& scratch);

/// Computes the modes S, m x modes, of the system, and stores their stiffness and damping in the model.
/// @param dependence  tolerance of linear dependence, for squared lengths of directions scaled to one
MatX modes_of(const ReducedSystem& system, double dependence, contact::ReducedContactModel& out);

}  // namespace palpate::loop
