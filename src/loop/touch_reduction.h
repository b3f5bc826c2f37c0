#pragma once
#include "palpate/contact/touch_model.h"
#include "palpate/core/archive.h"
#include "palpate/dynamics/step_assembly.h"
#include "palpate/linear/step_response.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

struct ToolSide;

/// Upper bounds on the relative error of the reduced response of the bodies to a tool, one per exchange
/// (linear::StepResponse::missing). Factored solves are exact.
struct AnswersMissing {
  long exchanges = 0;      ///< Exchanges with contact and a response.
  long factored = 0;       ///< Exchanges with a factored step matrix.
  long beyond_wanted = 0;  ///< Exchanges whose iteration ended above exchange.linearisation_error.
  double largest = 0.0, sum = 0.0;
  void take(double missing, double wanted);
  void take_factored();
  void archive(Archive& a);
};

/// Builds the reduced model of the bodies in contact with a tool, for the tool's ticks (touch_reduction.cpp).
class TouchReduction {
 public:
  /// @param error  exchange.linearisation_error: permitted relative error of the response; 0: factorise
  /// @param keep  keep the element results for others that need the same: a step, or another tool
  TouchReduction(World& world, double error, bool keep);
  ~TouchReduction();

  /// Builds the reduced model of the bodies in contact with this tool at the current state, valid for about
  /// `period_s`.
  /// @return false if the step matrix has no factor: `out` then has points without modes (bodies without
  /// response)
  bool reduce(World& world, ToolSide& side, double period_s, contact::TouchModel& out);
  const AnswersMissing& missing() const { return missing_; }
  void archive(Archive& a) { missing_.archive(a); }
  /// Performs one-time work (orderings, maps, allocation) ahead of the first contact.
  void prepare(World& world, double period_s);

 private:
  struct Answers;
  static Eigen::Index spread_patterns(Answers& x, Eigen::Index size);
  bool answer(World& world, ToolSide& side, double H, std::vector<contact::TouchSample>& samples,
              const std::vector<contact::TouchTangent>& tangents);
  bool improve(World& world, const ToolSide& side, double H, const std::vector<contact::TouchSample>& samples,
               const std::vector<contact::TouchTangent>& tangents);
  bool iterate(World& world, double H, Answers& out);
  bool factor(World& world, ToolSide& side, double H, Answers& out);

  AnswersMissing missing_;
  double error_;
  bool keep_;
  dynamics::StepAssembly assembly_;
  std::unique_ptr<linear::StepResponse> response_;
  std::unique_ptr<Answers> answers_;  ///< Memory is reused from exchange to exchange.
};

}  // namespace palpate::loop
