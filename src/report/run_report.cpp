#include "palpate/report/run_report.h"

#include "palpate/core/error.h"
#include "palpate/store/atomic_file.h"
#include "sections.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

/// References by scene.
std::map<std::string, ReferenceError> read_references(const Json& json) {
  std::map<std::string, ReferenceError> out;
  if (!json.contains("scenes")) return out;
  for (const Json& one : json["scenes"]) {
    ReferenceError& r = out[text_at(one, "scene")];
    r = {number_at(one, "position_error_rel_l2"),
         number_at(one, "force_error_rms_n"),
         number_at(one, "torque_error_rms_n_m"),
         number_at(one, "peak_force_n"),
         number_at(one, "peak_torque_n_m"),
         text_at(one, "description"),
         text_at(one, "trouble")};
    if (one.contains("notes"))
      for (const Json& note : one["notes"]) r.notes.push_back(note.get<std::string>());
  }
  return out;
}

void add_comparison_of(Page& page, const fs::path& dir) {
  const Json reference =
      fs::exists(dir / "reference.json") ? read_json(dir / "reference.json") : Json::object();
  add_comparison(page, read_csv(dir / "compare.csv"), read_references(reference),
                 text_at(reference, "rules"));
}

/// The scene as it was run: kept in summary.json, else the file beside the results.
std::string scene_source(const fs::path& dir, const Json& summary) {
  if (std::string source = text_at(summary, "scene_source"); !source.empty()) return source;
  return fs::exists(dir / "scene.toml") ? store::read_file((dir / "scene.toml").string()) : "";
}

bool holds_results(const fs::path& dir) {
  for (const char* name : {"summary.json", "force.csv", "clock.csv", "trace.csv", "compare.csv",
                           "restarts.csv", "exchange.csv", "haptic.csv", "validation.json", "stability.json"})
    if (fs::exists(dir / name)) return true;
  return false;
}

}  // namespace

RunReport write_run_report(const fs::path& dir) {
  if (!fs::is_directory(dir)) fail("{}: is not a directory; give the one that a run wrote", dir.string());
  if (!holds_results(dir))
    fail(
        "{}: holds no results to report (none of summary.json, force.csv, compare.csv, exchange.csv, "
        "validation.json, stability.json); give the directory that a run wrote",
        dir.string());
  const auto has = [&](const char* name) { return fs::exists(dir / name); };
  const Json summary = has("summary.json") ? read_json(dir / "summary.json") : Json::object();

  const std::string scene = text_at(summary, "scene");
  Page page(scene.empty() ? "palpate" : "palpate: " + scene);
  add_head(page, summary);
  add_pictures(page, summary, dir);
  if (has("force.csv")) add_forces(page, summary, read_csv(dir / "force.csv"));
  if (has("clock.csv")) add_clock(page, read_csv(dir / "clock.csv"));
  if (has("trace.csv")) add_trace(page, read_csv(dir / "trace.csv"));
  if (has("compare.csv")) add_comparison_of(page, dir);
  if (has("restarts.csv")) add_restarts(page, read_csv(dir / "restarts.csv"));
  if (has("exchange.csv")) add_exchange(page, read_csv(dir / "exchange.csv"));
  if (has("methods.csv")) add_methods(page, read_csv(dir / "methods.csv"));
  if (has("haptic.csv")) add_haptic(page, read_csv(dir / "haptic.csv"), summary);
  if (has("validation.json")) add_validation(page, read_json(dir / "validation.json"));
  if (has("stability.json")) add_stability(page, read_json(dir / "stability.json"));
  add_figures(page, summary);
  add_parts(page, summary);
  add_provenance(page, summary);
  if (const std::string source = scene_source(dir, summary); !source.empty())
    page.add_heading("The scene").add_code(source);
  const fs::path path = dir / "report.html";
  write(page, path);
  return {path, page.missing_figures()};
}

}  // namespace palpate::report
