#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/compare/mesh_run.h"
#include "experiments/engine.h"

namespace palpate::compare {

/// Outcome of one run, or the reason why there is none.
struct MeshOutcome {
  Status status = Status::kMissing;
  std::string reason;
  std::optional<MeshRun> run;  ///< Only with status kOk.
};

/// Runs of a comparison of meshes.  Runs that are equal are made once.
class MeshRuns : public experiments::Experiment {
 public:
  MeshRuns(double limit_s, bool alone) : limit_s_(limit_s), alone_(alone) {}

  /// Adds a run, unless it is there.  @param name  the run in words  @return its key, for outcome()
  std::string add(const scene::Description& description, const std::string& name);
  /// Returns the outcome of a run; missing before it was made.
  const MeshOutcome& outcome(const std::string& key) const;

  std::size_t size() const override { return runs_.size(); }
  experiments::Task task(std::size_t i) override;
  std::string input(std::size_t i) override;
  void take(std::size_t i, const experiments::Result& result) override;
  std::string progress_text(std::size_t i) override { return runs_[i].name; }
  std::string key() override;

 private:
  struct Planned {
    std::string key, name;
    scene::Description description;
  };
  double limit_s_;
  bool alone_;
  std::vector<Planned> runs_;
  std::map<std::string, MeshOutcome> outcomes_;
};

}  // namespace palpate::compare
