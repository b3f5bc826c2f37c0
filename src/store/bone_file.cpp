#include "store/bone_file.h"

#include <array>

namespace palpate::store {

const std::vector<std::string>& bone_headers() {
  static const std::vector<std::string> headers = {"time_s",
                                                   "bone",
                                                   "x_m",
                                                   "y_m",
                                                   "z_m",
                                                   "rotation_x_rad",
                                                   "rotation_y_rad",
                                                   "rotation_z_rad",
                                                   "velocity_x_m_s",
                                                   "velocity_y_m_s",
                                                   "velocity_z_m_s",
                                                   "angular_x_rad_s",
                                                   "angular_y_rad_s",
                                                   "angular_z_rad_s",
                                                   "force_x_n",
                                                   "force_y_n",
                                                   "force_z_n",
                                                   "torque_x_n_m",
                                                   "torque_y_n_m",
                                                   "torque_z_n_m"};
  return headers;
}

void BoneFile::append(const BoneRow& r) {
  std::array<double, 20> row{r.time_s, static_cast<double>(r.bone)};
  std::size_t at = 2;
  for (const Vec3& v : {r.pose.translation, rotation_vector(r.pose.rotation), r.twist.linear, r.twist.angular,
                        r.from_tissue.force, r.from_tissue.moment})
    for (int axis = 0; axis < 3; ++axis) row[at++] = v[axis];
  csv_.row(row);
}

std::vector<BoneRow> read_bones(const std::string& path) {
  const CsvTable table = read_csv(path);
  std::vector<std::vector<double>> columns;
  for (const std::string& header : bone_headers()) columns.push_back(table.numbers(header));
  std::vector<BoneRow> rows(table.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto vec = [&](std::size_t c) { return Vec3(columns[c][i], columns[c + 1][i], columns[c + 2][i]); };
    rows[i] = {columns[0][i],
               static_cast<int>(columns[1][i]),
               {quaternion_of(vec(5)), vec(2)},
               {vec(11), vec(8)},
               {vec(17), vec(14)}};
  }
  return rows;
}

}  // namespace palpate::store
