#pragma once
#include "palpate/contact/touch_model.h"
#include "palpate/core/archive.h"
#include "palpate/dynamics/step_assembly.h"
#include "palpate/linear/step_response.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

struct ToolSide;

/// By how much bodies answered the tool less than they would, relative: bounds, one an exchange
/// (linear::StepResponse::missing).  Bodies whose step matrix was factored answer exactly.
struct AnswersMissing {
  long exchanges = 0;      ///< in which they were touched, and answered
  long factored = 0;       ///< of these
  long beyond_wanted = 0;  ///< in which the iteration ended beyond exchange.linearisation_error
  double largest = 0.0, sum = 0.0;
  void take(double missing, double wanted);
  void take_factored();
  void archive(Archive& a);
};

/// Makes the model of the bodies that the tool's ticks touch (touch_reduction.cpp).
class TouchReduction {
 public:
  /// @param error  exchange.linearisation_error: of how much the modes may answer less, relative; 0:
  /// factorise
  /// @param keep  what the elements give, for others that ask for the same: a step, or another tool
  TouchReduction(World& world, double error, bool keep);
  ~TouchReduction();

  /// The bodies as that tool's contact sees them from the World's state on, for about `period_s`.
  /// @return false, and points without modes (bodies that do not answer), where the step matrix has no factor
  bool reduce(World& world, ToolSide& side, double period_s, contact::TouchModel& out);
  const AnswersMissing& missing() const { return missing_; }
  void archive(Archive& a) { missing_.archive(a); }
  /// Makes orders, maps and memory, where at the first touch a hand would wait for them.
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
  std::unique_ptr<Answers> answers_;  ///< its room is kept from exchange to exchange
};

}  // namespace palpate::loop
