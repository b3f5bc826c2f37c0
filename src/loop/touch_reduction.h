#pragma once
#include "palpate/contact/touch_model.h"
#include "palpate/dynamics/step_assembly.h"
#include "palpate/linear/step_response.h"
#include "palpate/loop/world.h"

namespace palpate::loop {

struct ToolSide;

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
  /// Makes orders, maps and memory, where at the first touch a hand would wait for them.
  void prepare(World& world, double period_s);

 private:
  struct Answers;
  static Eigen::Index spread_patterns(Answers& x, Eigen::Index size);
  bool iterate(World& world, double H, Answers& out);
  bool factor(World& world, ToolSide& side, double H, Answers& out);

  double error_;
  bool keep_;
  dynamics::StepAssembly assembly_;
  std::unique_ptr<linear::StepResponse> response_;
  std::unique_ptr<Answers> answers_;  ///< its room is kept from exchange to exchange
};

}  // namespace palpate::loop
