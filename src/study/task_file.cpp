#include "task_file.h"

#include <unistd.h>

#include <filesystem>

#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/json_text.h"
#include "store/provenance.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

/// Returns the command line that runs this task alone and keeps the recorded files.
std::string command_of(const Plan& plan, const Task& task) {
  std::string out = "palpate run " + quoted(plan.scenes[task.scene].path);
  for (const std::string& change : task.overrides) out += " --set " + quoted(change);
  return out;
}

}  // namespace

std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string result_path(const std::string& folder, const Task& task) {
  return (fs::path(folder) / "tasks" / (task.key + ".json")).string();
}

Json task_file(const Plan& plan, const Task& task, const Json& result) {
  Json settings = {{"scene", plan.scenes[task.scene].name}, {"integrator", task.integrator}};
  if (!task.rtol.empty()) settings["rtol"] = task.rtol;
  if (!task.step_s.empty()) settings["step_s"] = task.step_s;
  for (const auto& [name, value] : task.varied) settings[name] = value;
  const store::Provenance made_by = store::provenance();
  return {{"key", task.key},
          {"study", plan.spec.name},
          {"settings", settings},
          {"command", command_of(plan, task)},
          {"status", result.at("status")},
          {"reason", result.at("reason")},
          {"figures", result.at("figures")},
          {"limit_s", plan.spec.limit_s},
          {"repeats", plan.spec.repeats},
          {"times", result.at("times")},
          {"machine",
           {{"host", host_name()},
            {"cpu", made_by.cpu},
            {"cores", made_by.cores},
            {"system", made_by.system},
            {"palpate", made_by.version},
            {"commit", made_by.commit},
            {"ended_utc", made_by.started_utc}}}};
}

std::optional<Json> read_task_file(const std::string& folder, const Task& task) {
  const std::string path = result_path(folder, task);
  if (!fs::is_regular_file(path)) return {};
  Json file;
  try {
    file = store::parse_json(store::read_file(path), path);
  } catch (const Error&) { return {}; }  // Truncated, or not a result: the task is run again.
  const bool whole = file.is_object() && file.value("key", "") == task.key && file.contains("status") &&
                     file.contains("figures") && file["figures"].is_object() && file.contains("times") &&
                     file.contains("machine") && file.contains("limit_s");
  if (!whole) return {};
  return file;
}

bool is_final(const Plan& plan, const Json& file) {
  return file["status"] != "out of time" || !(file["limit_s"].get<double>() < plan.spec.limit_s);
}

std::string out_of_time_reason(const Plan& plan) {
  return fmt::format("out of time: {:g} s of CPU", plan.spec.limit_s);
}

}  // namespace palpate::study
