#include "experiments/compare/mesh_runs.h"

#include <algorithm>

#include "core/archive_bytes.h"
#include "experiments/compare/task_process.h"
#include "loop/result_key.h"
#include "palpate/core/error.h"

namespace palpate::compare {

std::string MeshRuns::add(const scene::Description& description, const std::string& name) {
  const std::string key = loop::result_key(description, "mesh");
  if (std::none_of(runs_.begin(), runs_.end(), [&](const Planned& run) { return run.key == key; }))
    runs_.push_back({key, name, description});
  return key;
}

const MeshOutcome& MeshRuns::outcome(const std::string& key) const {
  static const MeshOutcome missing;
  const auto found = outcomes_.find(key);
  return found == outcomes_.end() ? missing : found->second;
}

experiments::Task MeshRuns::task(std::size_t i) {
  const Planned& run = runs_[i];
  return {
      "mesh", run.key, run.name, run_job, limit_s_, alone_, std::max(1, run.description.integrator.threads)};
}

std::string MeshRuns::input(std::size_t i) {
  return encode_job(WorkKind::kMesh, runs_[i].description, limit_s_, nullptr);
}

void MeshRuns::take(std::size_t i, const experiments::Result& result) {
  MeshOutcome& out = outcomes_[runs_[i].key];
  // A process that was killed is a crash in this table, and runs again in the next call.
  out.status = result.status == Status::kMissing ? Status::kCrashed : result.status;
  out.reason = result.reason;
  if (result.status == Status::kOk) out.run = restored<MeshRun>(result.bytes);
}

std::string MeshRuns::key() {
  std::string keys;
  for (const Planned& run : runs_) keys += run.key;
  return experiments::key_of({"mesh", keys});
}

}  // namespace palpate::compare
