#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/tool/tool.h"
#include "stability.h"
#include "store/atomic_file.h"
#include "store/csv.h"
#include "store/summary.h"

namespace palpate::stability {

namespace {

/// Converts a number; one that is not finite becomes null, as JSON has no NaN.
nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json names_of(const Verdicts& verdicts) {
  auto list = nlohmann::ordered_json::array();
  for (int v = 0; v < kVerdicts; ++v)
    if (verdicts.has(static_cast<Verdict>(v))) list.push_back(to_string(static_cast<Verdict>(v)));
  return list;
}

nlohmann::ordered_json cell_to_json(const StabilityCell& cell) {
  return {{"row", cell.row},
          {"sub_case", cell.sub_case},
          {"integrator", cell.integrator},
          {"verdict", to_string(cell.verdict)},
          {"expected", names_of(cell.expected)},
          {"as_expected", cell.as_expected()},
          {"figure", cell.figure},
          {"energy_gain", number(cell.gain)},
          {"error", number(cell.error)},
          {"reason", cell.reason},
          {"steps", cell.steps},
          {"cpu_s", cell.cpu_s}};
}

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
  summary.outcome = matrix.outcome.stopped ? "interrupted" : "finished";
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
                                      {"stopped", matrix.outcome.stopped},
                                      {"wall_s", matrix.wall_s},
                                      {"rows", rows},
                                      {"cells", cells}};
  store::write_atomically((dir / "stability.json").string(), all.dump(1) + "\n");
}

}  // namespace palpate::stability
