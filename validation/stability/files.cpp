#include <filesystem>

#include "cell_json.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/tool/tool.h"
#include "store/atomic_file.h"
#include "store/csv.h"
#include "store/summary.h"

namespace palpate::stability {

namespace {

store::Provenance made_by() {
  store::Provenance p = store::provenance();
  for (const auto& library : integrate::library_versions()) p.libraries.push_back(library);
  for (const auto& library : linear::library_versions()) p.libraries.push_back(library);
  if (tool::available()) p.libraries.emplace_back("Simbody", tool::simbody_version());
  return p;
}

store::Summary summarise(const StabilityMatrix& matrix, const std::string& command) {
  store::Summary summary;
  summary.command = command;
  summary.scene = "stability";
  summary.outcome = matrix.stopped ? "interrupted" : "finished";
  summary.provenance = made_by();
  double cpu = 0.0;
  for (const StabilityCell& cell : matrix.cells) cpu += cell.cpu_s;
  summary.section("cells").values = {{"total", static_cast<long long>(matrix.cells.size())},
                                     {"unexpected", static_cast<long long>(matrix.unexpected())}};
  summary.section("timings").values = {{"wall_s", matrix.wall_s}, {"cells_cpu_s", cpu}};
  return summary;
}

}  // namespace

void write(const StabilityMatrix& matrix, const std::string& folder, const std::string& command) {
  const std::filesystem::path dir(folder);
  store::write_summary((dir / "summary.json").string(), summarise(matrix, command));
  store::CsvWriter csv((dir / "stability.csv").string(),
                       {"row", "sub_case", "integrator", "verdict", "expected", "as_expected", "figure",
                        "energy_gain", "error", "reason", "steps", "cpu_s"});
  auto cells = nlohmann::ordered_json::array();
  for (const StabilityCell& cell : matrix.cells) {
    csv.row({cell.row, cell.sub_case, cell.integrator, std::string(to_string(cell.verdict)),
             cell.expected.text(), std::string(cell.as_expected() ? "yes" : "no"), cell.figure, cell.gain,
             cell.error, cell.reason, static_cast<double>(cell.steps), cell.cpu_s});
    cells.push_back(cell_to_json(cell));
  }
  csv.close();
  auto rows = nlohmann::ordered_json::array();
  for (const StabilityRow& row : stability_rows())
    rows.push_back({{"name", row.name}, {"summary", row.summary}});
  const nlohmann::ordered_json all = {{"unexpected", matrix.unexpected()},
                                      {"stopped", matrix.stopped},
                                      {"wall_s", matrix.wall_s},
                                      {"rows", rows},
                                      {"cells", cells}};
  store::write_atomically((dir / "stability.json").string(), all.dump(1) + "\n");
}

}  // namespace palpate::stability
