#pragma once
#include <string>
#include <vector>

#include "report/table.h"
#include "report/work_precision.h"

namespace palpate::report {

/// An error that a comparison can show: its column, what it is called, and the reference's own.
struct Quantity {
  std::string column, label;
  double reference;
  double
      scale;  ///< size of what errs, in the error's unit: 1 of a relative error, else the peak; NaN: unknown
  std::string unit;  ///< "N"; empty for a relative error
};

/// Errors that are nowhere larger than this are rounding, and get no plot: a scene without torque has no
/// error of it.
constexpr double kRounding = 1e-15;

/// The comparison errors that the table holds.
std::vector<Quantity> quantities_of(const Table& table, const ReferenceError& reference);

std::string capitalised(std::string text);

/// The cell of a column as a short number; integers and words stay as they are; "-" where the column is
/// missing or empty.
std::string cell_text(const Table& table, std::size_t row, const std::string& column);

}  // namespace palpate::report
