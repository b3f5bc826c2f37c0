#include "result.h"

#include <algorithm>
#include <cmath>

#include "answers.h"
#include "palpate/core/error.h"
#include "sections.h"
#include "store/atomic_file.h"
#include "store/summary.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

/// Kind of result, and the files that contain it.
struct Kind {
  const char* name;
  std::vector<const char*> files;
};
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"Run", {"force.csv", "clock.csv", "trace.csv", "run.vtkhdf"}},
      {"Comparison", {"compare.csv", "restarts.csv", "exchange.csv", "methods.csv"}},
      {"Haptic comparison", {"haptic.csv"}},
      {"Mesh comparison", {"mesh.csv"}},
      {"Study", {"study.csv"}},
      {"Validation", {"validation.json"}},
      {"Stability", {"stability.json"}},
      {"Stability of the haptic loop", {"z_width.csv"}},
      {"Benchmark", {"bench-fem.json", "bench-fem-accuracy.json", "bench-contact.json"}}};
  return all;
}

std::vector<std::string> kinds_in(const fs::path& dir) {
  std::vector<std::string> out;
  for (const Kind& kind : kinds())
    if (std::any_of(kind.files.begin(), kind.files.end(),
                    [&](const char* file) { return fs::exists(dir / file); }))
      out.emplace_back(kind.name);
  // a run without recorded data
  if (out.empty() && fs::exists(dir / "summary.json")) out.emplace_back("Run");
  return out;
}

/// Returns the references by scene.
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

Json json_in(const fs::path& dir, const char* file) {
  return fs::exists(dir / file) ? read_json(dir / file) : Json::object();
}

/// Returns summary.json.  @throws Error where its keys are those of another schema
Json summary_in(const fs::path& dir) {
  Json summary = json_in(dir, "summary.json");
  if (const double schema = number_at(summary, "schema_version");
      std::isfinite(schema) && schema != store::kSummarySchema)
    fail("{}: schema_version is {:g}, and this version of palpate reads {}", (dir / "summary.json").string(),
         schema, store::kSummarySchema);
  return summary;
}

/// Returns the table of a study, with CPU times if there are any.
Table study_in(const fs::path& dir) {
  Table study = read_csv(dir / "study.csv");
  return fs::exists(dir / "study-times.csv") ? with_times(std::move(study), read_csv(dir / "study-times.csv"))
                                             : study;
}

/// Returns the source of the scene that was run, from summary.json, or else from scene.toml in the folder.
std::string scene_source(const Result& result) {
  if (std::string source = text_at(result.summary, "scene_source"); !source.empty()) return source;
  const fs::path file = result.dir / "scene.toml";
  return fs::exists(file) ? store::read_file(file.string()) : "";
}

std::vector<Answer> answers_of(const Result& result) {
  std::vector<Answer> out;
  const auto has = [&](const char* file) { return fs::exists(result.dir / file); };
  const auto is = [&](const char* kind) {
    return std::find(result.kinds.begin(), result.kinds.end(), kind) != result.kinds.end();
  };
  if (is("Run"))
    out.push_back(run_answer(
        result.summary, has("force.csv") ? std::optional(read_csv(result.dir / "force.csv")) : std::nullopt));
  if (has("compare.csv"))
    for (Answer& answer : comparison_answers(read_csv(result.dir / "compare.csv"),
                                             read_references(json_in(result.dir, "reference.json"))))
      out.push_back(std::move(answer));
  if (has("haptic.csv")) out.push_back(haptic_answer(read_csv(result.dir / "haptic.csv"), result.summary));
  if (has("study.csv")) out.push_back(study_answer(study_in(result.dir)));
  if (has("validation.json")) out.push_back(validation_answer(read_json(result.dir / "validation.json")));
  if (has("stability.json")) out.push_back(stability_answer(read_json(result.dir / "stability.json")));
  for (const char* file : kinds().back().files)
    if (has(file)) out.push_back(bench_answer(read_json(result.dir / file)));
  out.push_back(remarks_answer(result.summary));
  return out;
}

}  // namespace

std::string Result::title() const {
  std::string out;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    std::string name = kinds[i];
    if (i > 0) {
      name[0] = static_cast<char>(name[0] - 'A' + 'a');
      out += i + 1 < kinds.size() ? ", " : " and ";
    }
    out += name;
  }
  return of.empty() ? out : out + ": " + of;
}

std::string Result::first_answer() const {
  for (const Answer& answer : answers) {
    if (!answer.asks && !answer.lead.empty()) return answer.lead;
    if (!answer.points.empty()) return answer.points[0];
  }
  return "";
}

Result open_result(const fs::path& dir) {
  if (!fs::is_directory(dir))
    fail("{}: is not a directory; give the output directory of a run", dir.string());
  Result out{dir, kinds_in(dir), "", summary_in(dir), {}};
  if (out.kinds.empty())
    fail(
        "{}: contains no results to report (none of summary.json, force.csv, compare.csv, exchange.csv, "
        "haptic.csv, mesh.csv, study.csv, validation.json, stability.json, bench-*.json); give the directory "
        "that a run, a comparison, a study, a validation, a stability matrix or a benchmark wrote",
        dir.string());
  out.of = text_at(out.summary, "scene");
  if (out.of == "stability") out.of.clear();  // the cases of the matrix belong to no scene
  if (out.of.empty() && fs::exists(dir / "compare.csv"))
    for (const std::string& scene : distinct(read_csv(dir / "compare.csv"), "scene"))
      out.of += (out.of.empty() ? "" : ", ") + scene;
  out.answers = answers_of(out);
  return out;
}

void add_result(Page& page, const Result& result, const FirstView& view, bool picture) {
  const fs::path& dir = result.dir;
  const auto has = [&](const char* name) { return fs::exists(dir / name); };
  const auto csv = [&](const char* name) { return read_csv(dir / name); };
  const bool has_picture = picture && has(kPicture);
  if (has_picture) page.begin_lead().add_png(dir / kPicture, "");
  page.add_answer(result.answers);
  if (has_picture) page.end_lead();
  if (has("run.vtkhdf"))
    add_motion(page, dir / "run.vtkhdf", result.summary,
               has("force.csv") ? time_of_peak_force(csv("force.csv")) : kUnknown, view);
  add_pictures(page, dir);
  if (has("force.csv")) add_forces(page, result.summary, csv("force.csv"), dir);
  if (has("clock.csv")) add_clock(page, csv("clock.csv"));
  if (has("trace.csv")) add_trace(page, csv("trace.csv"));
  if (has("compare.csv")) {
    const Json reference = json_in(dir, "reference.json");
    add_comparison(page, csv("compare.csv"), read_references(reference), text_at(reference, "rules"));
  }
  if (has("restarts.csv")) add_restarts(page, csv("restarts.csv"));
  if (has("exchange.csv")) add_exchange(page, csv("exchange.csv"));
  if (has("methods.csv")) add_methods(page, csv("methods.csv"));
  if (has("haptic.csv")) add_haptic(page, csv("haptic.csv"), result.summary);
  if (has("mesh.csv")) add_mesh(page, csv("mesh.csv"), result.summary);
  if (has("study.csv"))
    add_study(page, study_in(dir),
              has("study.toml") ? store::read_file((dir / "study.toml").string()) : std::string(),
              result.summary);
  if (has("validation.json")) add_validation(page, read_json(dir / "validation.json"));
  if (has("stability.json")) add_stability(page, read_json(dir / "stability.json"));
  if (has("z_width.csv")) add_z_width(page, csv("z_width.csv"), result.summary);
  for (const char* file : kinds().back().files)
    if (has(file)) add_bench(page, file, read_json(dir / file));
  add_head(page, result.summary);
  add_figures(page, result.summary);
  add_parts(page, result.summary);
  add_provenance(page, result.summary);
  if (const std::string source = scene_source(result); !source.empty())
    page.add_heading("Scene").begin_details("Scene file of the run").add_code(source).end_details();
}

}  // namespace palpate::report
