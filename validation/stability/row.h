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
  const std::atomic<bool>* expired = nullptr;  ///< Time limit of the cell.
  bool time_is_up() const { return expired && expired->load(std::memory_order_relaxed); }
};

/// Determines whether a run ended early, and sets the verdict of `cell`: too slow, not finite, grown, error,
/// silent. Returns false if it reached its end. For an implicit method, growth beyond every bound followed by
/// a failure is not an acceptable end: only an explicit method may end in this way.
/// @param grown whether the bound on energy or motion was exceeded
bool ended_early(const Column& column, const dynamics::StepResult& result, bool finite, bool interrupted,
                 bool grown, StabilityCell& cell);

/// Sets the verdict "wrong" if `mistake` is not empty, and puts it before the cell's present reason.
void mark_wrong(const std::string& mistake, StabilityCell& cell);

struct SubCase {
  std::string name;
  std::function<Verdicts(const CaseContext&)> expect;  ///< From theory, before any part of the case has run.
  /// Runs the case and returns verdict and figures. May throw Error (a rejection, which is an acceptable
  /// end).
  std::function<StabilityCell(const CaseContext&)> run;
};

/// Columns of a row.
enum class RowColumns {
  kSteppers,
  kFixedSteppers,  ///< Methods that move at fixed steps: no error control, no statics.
  kFamilies,       ///< A few fixed steppers, one per way of stepping.
  kSplitting,      ///< Additive and multi-rate methods.
  kTools
};

/// One row of section F. Each has a separate file, with the theory of its expectations on top.
struct Row {
  std::string name, summary;
  RowColumns columns = RowColumns::kSteppers;
  bool slow = false;
  std::vector<SubCase> cases{};
  std::size_t core = 0;  ///< Sub-case that represents the row in the core of the matrix.
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
