#pragma once
#include <limits>
#include <string>
#include <vector>

#include "report/table.h"
#include "report/work_precision.h"

namespace palpate::report {

/// Error that a comparison can show: its column and name, and the error of the reference.
struct Quantity {
  std::string column, label;
  double reference;  ///< Error of the reference
  double scale;  ///< Size of the erring quantity, in the unit of the error: 1 for a relative error, else the
                 ///< peak; NaN: unknown
  std::string unit;  ///< Unit of the error, as "N"; empty for a relative error
};

/// Threshold below which errors are rounding. A quantity whose errors are all below it has no plot: a scene
/// without torque has no torque error.
constexpr double kRounding = 1e-15;

/// Returns the comparison errors that the table contains.
std::vector<Quantity> quantities_of(const Table& table, const ReferenceError& reference);

/// Returns the text with its first letter in upper case.
std::string capitalised(std::string text);

/// Returns the cell of a column as a short number; integers and words are unchanged; "-" if the column is
/// missing or the cell is empty.
std::string cell_text(const Table& table, std::size_t row, const std::string& column);

/// Returns these columns of the first `most` rows as cell_text().
Rows cells_of(const Table& table, const std::vector<std::string>& columns,
              std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace palpate::report
