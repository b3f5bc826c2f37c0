#pragma once
#include <string>
#include <vector>

#include "palpate/loop/world.h"
#include "store/csv.h"

namespace palpate::loop {

/// Readable name of a direction of the state: "liver", 12, "z" for a body's node; "tool", -1, "rotation x"
/// for a rigid body.
struct NamedDirection {
  std::string block;
  int node = -1;  ///< Node of a body, as numbered in the state; -1: not a node.
  std::string axis;
};
/// Returns the name of direction `dof` of u; empty for none.
NamedDirection name_of(const dynamics::Layout& layout, int dof);

/// Writer of trace.csv: one line per attempted step, with the reason of a rejection (`palpate run --trace`).
class TraceRecorder final : public dynamics::StepTrace {
 public:
  static const std::vector<std::string>& columns();

  /// Traces the world's stepper until destruction.  @throws Error if the scene has no stepper, or the file
  /// cannot be created
  TraceRecorder(World& world, const std::string& path);
  ~TraceRecorder() override;
  void attempt(const dynamics::StepAttempt& attempt) override;
  void close();  ///< @throws Error if the disk reported an error
  long attempts() const { return attempts_; }
  long rejected() const { return rejected_; }

 private:
  World& world_;
  store::CsvWriter csv_;
  long attempts_ = 0, rejected_ = 0;
};

}  // namespace palpate::loop
