#pragma once
#include <memory>
#include <vector>

#include "contact/reduced_contact_model.h"
#include "implicit_step.h"
#include "linear/step_response.h"
#include "palpate/core/archive.h"
#include "palpate/dynamics/step_assembly.h"

namespace palpate::loop {

/// Upper bounds on the relative error of the reduced response of the bodies to a tool, one per exchange
/// (linear::StepResponse::missing). Factored solves are exact.
struct ReductionError {
  long exchanges = 0;      ///< Exchanges with contact and a response.
  long factored = 0;       ///< Exchanges with a factored step matrix.
  long beyond_wanted = 0;  ///< Exchanges whose iteration ended above exchange.linearisation_error.
  double largest = 0.0, sum = 0.0;
  void take(double error_bound, double requested);
  void take_factored();
  void archive(Archive& a);
};

/// Parameters of a model reduction.
struct ReductionOptions {
  /// Damping coefficients of one body, D = mass M + stiffness K [1/s, s].
  struct Damping {
    int block_id;
    double mass, stiffness;
  };
  double error = 0.0;  ///< exchange.linearisation_error: permitted relative error; 0: factorise
  bool keep = false;   ///< Keep the element results for others that need the same: a step, or another tool.
  int threads = 1;     ///< Threads of the iteration.
  bool has_friction = false;          ///< A contact of the tool has friction.
  bool others_touch = false;          ///< The bodies have contacts without this tool.
  std::vector<Damping> damping = {};  ///< One per body.
};

/// Builds the reduced model of the bodies in contact with a tool, for the tool's ticks (model_reduction.cpp).
class ModelReduction {
 public:
  ModelReduction(dynamics::System& system, ReductionOptions options);
  ~ModelReduction();

  /// Builds the reduced model of the bodies in contact with this tool at the current state, valid for about
  /// `period_s`.
  /// @return false if the step matrix has no factor: `out` then has points without modes (bodies without
  /// response)
  bool reduce(const CoupledTool& tool, double period_s, contact::ReducedContactModel& out);
  const ReductionError& error_bound() const { return error_bound_; }
  void archive(Archive& a) { error_bound_.archive(a); }
  /// Performs one-time work (orderings, maps, allocation) ahead of the first contact.
  void prepare(const dynamics::State& state, double period_s);

 private:
  struct StepResponses;
  static Eigen::Index spread_patterns(StepResponses& x, Eigen::Index size);
  bool answer(const CoupledTool& tool, double H, std::vector<contact::ReducedSample>& samples,
              const std::vector<contact::ReducedTangent>& tangents);
  bool update_friction(const CoupledTool& tool, double H, const std::vector<contact::ReducedSample>& samples,
                       const std::vector<contact::ReducedTangent>& tangents);
  bool iterate(const CoupledTool& tool, double H, StepResponses& out);
  bool factorise(const CoupledTool& tool, double H, StepResponses& out);

  ReductionError error_bound_;
  ReductionOptions options_;
  dynamics::StepAssembly assembly_;
  std::unique_ptr<linear::StepResponse> response_;  ///< null: factorise
  StepFactor factor_;                               ///< Used if the iteration cannot be.
  std::unique_ptr<StepResponses> responses_;        ///< Memory is reused from exchange to exchange.
};

}  // namespace palpate::loop
