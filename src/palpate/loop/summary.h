#pragma once
#include "palpate/loop/run.h"
#include "palpate/scene/needs.h"
#include "palpate/store/summary.h"

namespace palpate::loop {

/// scene::needs() with the linear solver that the scene's integrator will use.
std::vector<scene::Need> needs(const scene::Description& description);

/// What the device of a hand has counted (device::Device::tallies).
std::vector<std::pair<std::string, long long>> tallies_of(const World& world, std::size_t hand);

/// How deep the two sides of a [[contact]] lay in each other, and what the sum over its points errs.
struct Overlap {
  std::string pair;        ///< "head - tool"
  double deepest_m = 0.0;  ///< the largest overlap that a query saw; 0: they never touched
  /// half of the smaller extent of the boxes around either side: what lies deeper is pushed out at the far
  /// side, or nowhere; infinite where they never touched.  Of a body against itself three quarters of the
  /// depth up to which its overlaps are found
  double half_width_m = 0.0;
  bool of_itself = false;  ///< of a body
  /// part of the depth up to which overlaps of a body with itself are found, at which they are too deep: so
  /// that a run says so before they are lost
  static constexpr double kOwnShare = 0.75;
  double quadrature_error = 0.0;  ///< relative, as contact::SumError::largest(); 0: not estimated
  double largest_share = 0.0;     ///< of one point
  bool too_deep() const { return deepest_m > half_width_m; }
};
/// One for each [[contact]] of the scene.
std::vector<Overlap> overlaps_of(const World& world);

/// How exactly bodies answered a tool within its exchanges ("points"; loop/touch_reduction.h): bounds of what
/// they answered less than they would, relative.
struct AnswerError {
  std::string tool;                  ///< as [[contact]] calls it
  double wanted = 0.0;               ///< exchange.linearisation_error
  double largest = 0.0, mean = 0.0;  ///< over the exchanges
  long exchanges = 0;                ///< in which a body was touched
  long beyond = 0;                   ///< of these: the iteration ended beyond what was wanted
  long factored = 0;                 ///< of these: exact
};
/// One for each tool that touched a body so.
std::vector<AnswerError> answer_errors_of(const World& world);

/// Summary of a run and its cost: options, sizes, counts, timings, constructions.  The caller adds the
/// command line and writes it.
store::Summary summarise(const World& world, const RunResult& result, double assemble_s);

}  // namespace palpate::loop
