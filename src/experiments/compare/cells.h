#pragma once
#include <limits>
#include <string>

#include "store/csv.h"

/// Cells of compare.csv and haptic.csv.
namespace palpate::compare {

constexpr double kEmpty = std::numeric_limits<double>::quiet_NaN();  // Value of an empty cell.

inline store::CsvCell yes_no(bool yes) { return std::string(yes ? "yes" : "no"); }

}  // namespace palpate::compare
