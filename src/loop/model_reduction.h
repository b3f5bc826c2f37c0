#pragma once
#include "contact/reduced_contact_model.h"
#include "linear/step_response.h"
#include "palpate/core/archive.h"
#include "palpate/dynamics/step_assembly.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

struct ToolInstance;

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

/// Builds the reduced model of the bodies in contact with a tool, for the tool's ticks (touch_reduction.cpp).
class ModelReduction {
 public:
  /// @param error  exchange.linearisation_error: permitted relative error of the response; 0: factorise
  /// @param keep  keep the element results for others that need the same: a step, or another tool
  ModelReduction(World& world, double error, bool keep);
  ~ModelReduction();

  /// Builds the reduced model of the bodies in contact with this tool at the current state, valid for about
  /// `period_s`.
  /// @return false if the step matrix has no factor: `out` then has points without modes (bodies without
  /// response)
  bool reduce(World& world, ToolInstance& side, double period_s, contact::ReducedContactModel& out);
  const ReductionError& error_bound() const { return error_bound_; }
  void archive(Archive& a) { error_bound_.archive(a); }
  /// Performs one-time work (orderings, maps, allocation) ahead of the first contact.
  void prepare(World& world, double period_s);

 private:
  struct StepResponses;
  static Eigen::Index spread_patterns(StepResponses& x, Eigen::Index size);
  bool answer(World& world, ToolInstance& side, double H, std::vector<contact::ReducedSample>& samples,
              const std::vector<contact::ReducedTangent>& tangents);
  bool update_friction(World& world, const ToolInstance& side, double H,
                       const std::vector<contact::ReducedSample>& samples,
                       const std::vector<contact::ReducedTangent>& tangents);
  bool iterate(World& world, double H, StepResponses& out);
  bool factor(World& world, ToolInstance& side, double H, StepResponses& out);

  ReductionError error_bound_;
  double error_;
  bool keep_;
  dynamics::StepAssembly assembly_;
  std::unique_ptr<linear::StepResponse> response_;
  std::unique_ptr<StepResponses> responses_;  ///< Memory is reused from exchange to exchange.
};

}  // namespace palpate::loop
