#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "column.h"
#include "stability.h"

namespace palpate::stability {

/// Input of a case.
struct CaseContext {
  const Column& column;
  int seeds = 10;
  const std::atomic<bool>* expired = nullptr;  ///< the cell's time is up
  bool time_is_up() const { return expired && expired->load(std::memory_order_relaxed); }
};

/// Decides whether a run ended before its time, and sets the verdict of `cell`: too slow, not finite, grown,
/// error, silent.  False where it reached its end.  An implicit method that first grows beyond every bound
/// and then fails has no acceptable end: only an explicit one may end so.
/// @param grown  whether the bound on energy or motion was passed
bool ended_early(const Column& column, const dynamics::StepResult& result, bool finite, bool interrupted,
                 bool grown, StabilityCell& cell);

/// Sets the verdict "wrong" where `mistake` is not empty, before what the cell says already.
void mark_wrong(const std::string& mistake, StabilityCell& cell);

struct SubCase {
  std::string name;
  std::function<Verdicts(const CaseContext&)> expect;  ///< from theory, before anything of the case has run
  /// Runs it: verdict and figures.  May throw Error (a refusal: that is an acceptable end).
  std::function<StabilityCell(const CaseContext&)> run;
};

/// Which columns a row has.
enum class RowColumns {
  kSteppers,
  kFixedSteppers,  ///< those that move at fixed steps: no error control, no statics
  kFamilies,       ///< a few of those, one for each way of stepping
  kSplitting,      ///< additive and multi-rate methods
  kTools
};

/// One row of section F.  Each stands in a file of its own, with the theory that its expectations follow from
/// on top.
struct Row {
  std::string name, summary;
  RowColumns columns = RowColumns::kSteppers;
  bool slow = false;
  std::vector<SubCase> cases{};
  std::size_t core = 0;  ///< the sub-case that stands for the row in the core of the matrix
};

Row youngs_modulus_row();
Row poissons_ratio_row();
Row undamped_row();
Row stiff_modes_row();
Row step_row();
Row split_row();
Row elements_row();
Row sliver_row();
Row squashed_row();
Row two_bodies_row();
Row contact_stiffness_row();
Row impact_row();
Row density_ratio_row();
Row swallowed_tool_row();
Row thrown_handle_row();
Row rest_row();
Row size_row();
Row million_ticks_row();
Row million_tool_ticks_row();
Row million_touch_ticks_row();

std::vector<Row> all_rows();

std::vector<Column> columns_of(const Row& row, const dynamics::StepperRegistry& registry);

}  // namespace palpate::stability
