#pragma once
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "stability/stability.h"

namespace palpate::stability {

inline void PrintTo(const StabilityRow& row, std::ostream* out) { *out << row.name; }

inline std::string name_of_row(const testing::TestParamInfo<StabilityRow>& param) {
  std::string name = param.param.name;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
}

/// @param slow also includes rows that take minutes
inline std::vector<StabilityRow> rows_of_the_matrix(bool slow) {
  std::vector<StabilityRow> rows = stability_rows();
  std::erase_if(rows,
                [slow](const StabilityRow& row) { return (row.slow && !slow) || row.sub_cases.empty(); });
  return rows;
}

inline std::string unexpected_of(const StabilityMatrix& matrix) {
  std::string out;
  for (const StabilityCell& c : matrix.cells)
    if (!c.as_expected())
      out += fmt::format("{} / {} / {}: {}, expected {}; {}; {}\n", c.row, c.sub_case, c.integrator,
                         to_string(c.verdict), c.expected.text(), c.figure, c.reason);
  return out;
}

}  // namespace palpate::stability
