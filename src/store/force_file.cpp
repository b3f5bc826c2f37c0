#include "store/force_file.h"

#include <array>

namespace palpate::store {
namespace {
constexpr std::size_t kColumns = 1 + 6 + 6 + 6 + 2;
using Row = std::array<double, kColumns>;

/// Packs one row.  Rotations are written as rotation vectors: three numbers, without sign ambiguity, and
/// plottable.
Row flatten(const ForceRow& r) {
  const Vec3 handle = rotation_vector(r.handle.rotation), tool = rotation_vector(r.tool.rotation);
  Row row{};
  row[0] = r.time_s;
  std::size_t at = 1;
  for (const Vec3& v :
       {r.handle.translation, handle, r.tool.translation, tool, r.on_hand.force, r.on_hand.moment})
    for (int axis = 0; axis < 3; ++axis) row[at++] = v[axis];
  row[at++] = r.limited ? 1.0 : 0.0;
  row[at] = r.switches;
  return row;
}
}  // namespace

const std::vector<std::string>& force_headers() {
  static const std::vector<std::string> headers = {"time_s",
                                                   "handle_x_m",
                                                   "handle_y_m",
                                                   "handle_z_m",
                                                   "handle_rotation_x_rad",
                                                   "handle_rotation_y_rad",
                                                   "handle_rotation_z_rad",
                                                   "tool_x_m",
                                                   "tool_y_m",
                                                   "tool_z_m",
                                                   "tool_rotation_x_rad",
                                                   "tool_rotation_y_rad",
                                                   "tool_rotation_z_rad",
                                                   "force_x_n",
                                                   "force_y_n",
                                                   "force_z_n",
                                                   "torque_x_n_m",
                                                   "torque_y_n_m",
                                                   "torque_z_n_m",
                                                   "limited",
                                                   "switches"};
  return headers;
}

void ForceFile::append(const ForceRow& row) {
  const Row flat = flatten(row);
  csv_.row(flat);
}

std::vector<ForceRow> read_forces(const std::string& path) {
  const CsvTable table = read_csv(path);
  std::vector<std::vector<double>> columns;
  for (const std::string& header : force_headers()) columns.push_back(table.numbers(header));
  std::vector<ForceRow> rows(table.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto vec = [&](std::size_t c) { return Vec3(columns[c][i], columns[c + 1][i], columns[c + 2][i]); };
    rows[i] = {
        columns[0][i],      {quaternion_of(vec(4)), vec(1)}, {quaternion_of(vec(10)), vec(7)},
        {vec(16), vec(13)}, columns[19][i] != 0.0,           static_cast<std::uint32_t>(columns[20][i])};
  }
  return rows;
}

}  // namespace palpate::store
