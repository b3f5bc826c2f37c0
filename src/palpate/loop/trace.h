#pragma once
#include <string>
#include <vector>

#include "palpate/loop/world.h"
#include "palpate/store/csv.h"

namespace palpate::loop {

/// A direction of the state, for people: "liver", 12, "z" of a body's node; "tool", -1, "rotation x" of a
/// rigid body.
struct NamedDirection {
  std::string block;
  int node = -1;  ///< of a body, as numbered in the state; -1: not a node
  std::string axis;
};
NamedDirection name_of(const dynamics::Layout& layout, int dof);

/// trace.csv: one line an attempted step, and why it was rejected (`palpate run --trace`).
class TraceRecorder final : public dynamics::StepTrace {
 public:
  static const std::vector<std::string>& columns();

  /// Listens to the world's stepper from now until it dies.  @throws Error where the scene has no stepper, or
  /// the file cannot be made
  TraceRecorder(World& world, const std::string& path);
  ~TraceRecorder() override;
  void attempt(const dynamics::StepAttempt& attempt) override;
  void close();  ///< @throws Error when the disk refused anything
  long attempts() const { return attempts_; }
  long rejected() const { return rejected_; }

 private:
  World& world_;
  store::CsvWriter csv_;
  long attempts_ = 0, rejected_ = 0;
};

}  // namespace palpate::loop
