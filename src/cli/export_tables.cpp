#include "export_tables.h"

#include <filesystem>

#include "cli/stop.h"
#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "store/csv.h"

namespace palpate::cli {
namespace fs = std::filesystem;

void write_node_table(const store::RunReader& run, const std::vector<int>& steps,
                      const std::vector<int>& parts, const std::string& path) {
  std::vector<std::string> headers = {"time_s", "state", "part", "node"};
  for (const char* header : {"x_m", "y_m", "z_m", "displacement_x_m", "displacement_y_m", "displacement_z_m",
                             "velocity_x_m_s", "velocity_y_m_s", "velocity_z_m_s", "stress_pa"})
    headers.emplace_back(header);
  store::CsvWriter table(path, headers);
  for (const int step : steps) {
    if (stop_flag().load()) return;
    const Points points = run.points(step), displacement = run.displacement(step),
                 velocity = run.velocity(step);
    const VecX stress = run.stress(step);
    std::vector<store::CsvCell> row = {run.times_s()[static_cast<std::size_t>(step)],
                                       static_cast<double>(step)};
    row.resize(headers.size());
    for (const int number : parts) {
      const store::RunPart& part = run.parts()[static_cast<std::size_t>(number)];
      row[2] = part.name;
      for (Eigen::Index node = 0; node < part.reference.cols(); ++node) {
        const Eigen::Index at = run.first_point(number) + node;
        row[3] = static_cast<double>(node);
        for (int axis = 0; axis < 3; ++axis) {
          const auto column = static_cast<std::size_t>(axis);
          row[4 + column] = points(axis, at);
          row[7 + column] = displacement(axis, at);
          row[10 + column] = velocity(axis, at);
        }
        row[13] = stress[at];
        table.row(row);
      }
    }
  }
  table.close();
}

std::vector<std::string> recorded_tables(const store::RunReader& run, const std::string& run_file) {
  const fs::path folder = fs::path(run_file).parent_path();
  const scene::Description d = loop::parse(run.info().scene_source, (folder / "scene.toml").string());
  std::vector<std::string> names, out;
  if (!d.record || fs::path(run_file).stem() != "run") return out;
  if (d.record->forces && d.tool) {
    names.emplace_back("force.csv");
    for (const scene::HandSpec& hand : d.hands) names.push_back(fmt::format("force-{}.csv", hand.name));
  }
  if (d.record->states) names.emplace_back("bones.csv");
  if (d.record->energy) names.emplace_back("energy.csv");
  for (const std::string& name : names)
    if (fs::exists(folder / name)) out.push_back(name);
  return out;
}

}  // namespace palpate::cli
