#include "outcome.h"

#include <fmt/format.h>

#include "core/clock.h"
#include "report/table.h"

namespace palpate::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

std::string triple(const Vec3& x) { return fmt::format("{:.4g} {:.4g} {:.4g}", x.x(), x.y(), x.z()); }

Rows figures(const model::Made& made) {
  const model::TetQuality& q = made.quality;
  const LayeredModel& m = made.file.model;
  Rows rows;
  const auto add = [&](const std::string& name, const std::string& value) { rows.push_back({name, value}); };
  add("nodes", fmt::format("{}", q.nodes));
  add("tetrahedra", fmt::format("{}", q.tetrahedra));
  add("skin vertices", fmt::format("{}", m.skin.vertices.cols()));
  add("skin faces", fmt::format("{}", m.skin.faces.cols()));
  if (!m.proxies.empty()) add("convex proxies", fmt::format("{}", m.proxies.size()));
  if (!m.skeleton.bones.empty()) add("bones", fmt::format("{}", m.skeleton.bones.size()));
  add("smallest dihedral angle [deg]", fmt::format("{:.2f}", q.smallest_dihedral_deg));
  add("largest dihedral angle [deg]", fmt::format("{:.2f}", q.largest_dihedral_deg));
  add("worst aspect ratio", fmt::format("{:.2f}", q.worst_aspect));
  add("mean edge [m]", fmt::format("{:.4g}", q.mean_edge));
  const Points& nodes = m.tets.nodes;
  const Vec3 low = nodes.rowwise().minCoeff(), high = nodes.rowwise().maxCoeff();
  add("bounding box: size [m]", triple(high - low));
  add("bounding box: from [m]", triple(low));
  add("bounding box: to [m]", triple(high));
  add("mass at 1000 kg/m^3 [kg]", fmt::format("{:.4g}", 1000.0 * q.volume));
  add("volume [m^3]", fmt::format("{:.6g}", q.volume));
  add("volume error [%]", fmt::format("{:.4f}", 100 * q.volume_error));
  for (const auto& [name, value] : made.file.record.figures) {
    if (name == "skin_vertices_outside")
      add("skin vertices outside the tetrahedra", fmt::format("{:.0f}", value));
    if (name == "farthest_outside_m") add("largest distance outside [m]", fmt::format("{:.3g}", value));
    if (name == "nodes_on_bones") add("nodes on bones", fmt::format("{:.0f}", value));
  }
  return rows;
}

}  // namespace

void print_outcome(const model::Made& made, const std::string& path) {
  const store::ModelRecord& record = made.file.record;
  fmt::print("{}: {}\n", made.file.model.name, record.source);
  for (const std::string& note : record.notes) fmt::print("  {}\n", note);
  fmt::print("\n{}\n", report::format_table({"outcome", ""}, figures(made)));
  if (!made.regions.empty()) {
    Rows regions;
    for (const model::RegionFigures& r : made.regions)
      regions.push_back({r.name, fmt::format("{}", r.tetrahedra), fmt::format("{:.6g}", r.volume),
                         r.surface_volume > 0 ? fmt::format("{:.6g}", r.surface_volume) : "-"});
    fmt::print("{}\n",
               report::format_table({"region", "tetrahedra", "volume [m^3]", "of its surface"}, regions));
  }
  Rows rows;
  double sum = 0;
  for (const model::Step& step : made.steps) {
    rows.push_back({step.name, fmt::format("{:.2f}", step.seconds)});
    sum += step.seconds;
  }
  rows.push_back({"all", fmt::format("{:.2f}", sum)});
  fmt::print("{}\npeak memory: {:.0f} MiB\nwritten: {}\n", report::format_table({"step", "seconds"}, rows),
             peak_memory_mib(), path);
}

}  // namespace palpate::cli
