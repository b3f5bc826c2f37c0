#include "comparison_cells.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::report {

std::vector<Quantity> quantities_of(const Table& table, const ReferenceError& reference) {
  const auto size_of = [](double peak) { return peak > kLeastPeak ? peak : kUnknown; };
  const std::vector<Quantity> all = {
      {"position_error_rel_l2", "position error, relative L2 [-]", reference.position_error_rel_l2, 1.0, ""},
      {"force_error_rms_n", "force error, RMS [N]", reference.force_error_rms_n,
       size_of(reference.peak_force_n), "N"},
      {"torque_error_rms_n_m", "torque error, RMS [N m]", reference.torque_error_rms_n_m,
       size_of(reference.peak_torque_n_m), "N m"}};
  std::vector<Quantity> present;
  for (const Quantity& q : all)
    if (table.exceeds(q.column, kRounding)) present.push_back(q);
  return present;
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string cell_text(const Table& table, std::size_t row, const std::string& column) {
  return table.has(column) ? short_cell(table.cell(row, column)) : "-";
}

Rows cells_of(const Table& table, const std::vector<std::string>& columns, std::size_t most) {
  Rows rows;
  for (std::size_t r = 0; r < std::min(most, table.rows.size()); ++r) {
    rows.emplace_back();
    for (const std::string& column : columns) rows.back().push_back(cell_text(table, r, column));
  }
  return rows;
}

}  // namespace palpate::report
