// A scripted stepper: the trace contains its attempts; an interruption ends the run.
#include "loop/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "store/csv.h"
#include "temporary_folder.h"

using namespace palpate;
using dynamics::StepAttempt;

namespace {

constexpr int kWorstNode = 40;  // in the numbering of the state

/// Steps of 1 ms that change nothing; each is preceded by one attempt of 4 ms that fails its error test at
/// node kWorstNode, axis y.
class FakeStepper final : public dynamics::Stepper {
 public:
  FakeStepper(dynamics::State& state, std::atomic<bool>* raise, int raise_after)
      : state_(state), raise_(raise), raise_after_(raise_after) {}
  std::string name() const override { return "fake"; }
  dynamics::StepResult advance_to(double t_end) override {
    dynamics::StepResult result;
    while (state_.time() < t_end - 1e-12) {
      if (trace()) {
        trace()->attempt({state_.time(), 4e-3, 3, 7.5, 2, StepAttempt::Outcome::kErrorTest,
                          3 * kWorstNode + 1, 4, "block"});
        trace()->attempt({state_.time(), 1e-3, 3, 0.5, 2, StepAttempt::Outcome::kAccepted, 0, -1, ""});
      }
      state_.set_time(state_.time() + 1e-3);
      if (raise_ && ++counters_.steps == raise_after_) *raise_ = true;
      if (interrupted()) {
        result.status = dynamics::StepStatus::kInterrupted;
        result.message = "interrupted";
        return result;
      }
    }
    state_.set_time(t_end);
    return result;
  }
  bool dense_output(double, VecX&, VecX&) const override { return false; }
  void reinit(dynamics::ReinitReason) override {}
  const dynamics::StepperCounters& counters() const override { return counters_; }

 private:
  dynamics::State& state_;
  std::atomic<bool>* raise_;
  int raise_after_;
  dynamics::StepperCounters counters_;
};

std::unique_ptr<loop::World> faked(std::atomic<bool>* raise = nullptr, int raise_after = 0) {
  auto world = loop::assemble(small_scenes::held_block());
  world->stepper = std::make_unique<FakeStepper>(world->state, raise, raise_after);
  return world;
}

TEST(Trace, WritesEveryAttemptWithItsReasonAndNode) {
  const TemporaryFolder folder;
  const auto path = folder / "trace.csv";
  const auto world = faked();
  {
    loop::TraceRecorder trace(*world, path.string());
    loop::RunOptions options;
    options.duration_s = 0.005;
    ASSERT_TRUE(loop::run(*world, options).status.ok());
    trace.close();
    EXPECT_EQ(trace.attempts(), 10);
    EXPECT_EQ(trace.rejected(), 5);
  }
  world->stepper->advance_to(1.0);  // after the trace was closed
  const store::CsvTable table = store::read_csv(path.string());
  EXPECT_EQ(table.headers, loop::TraceRecorder::columns());
  ASSERT_EQ(table.rows.size(), 10u);
  const std::vector<int>& file_node = world->bodies[0].file_node;
  EXPECT_NE(file_node[kWorstNode],
            kWorstNode);  // otherwise the test could not detect which numbering is written
  EXPECT_EQ(table.rows[0],
            (std::vector<std::string>{"0", "0.004", "3", "7.5", "2", "error test", "block",
                                      std::to_string(file_node[kWorstNode]), "y", "block", "4", "0"}));
  EXPECT_EQ(table.rows[1], (std::vector<std::string>{"0", "0.001", "3", "0.5", "2", "accepted", "block",
                                                     std::to_string(file_node[0]), "x", "", "", "0"}));
}

TEST(Trace, NamesDirectionsOfBodiesAndTools) {
  dynamics::State state;
  dynamics::BlockSpec body{"liver", dynamics::BlockKind::kNodes, 6, 6},
      tool{"probe", dynamics::BlockKind::kRigidBody, 7, 6};
  tool.kinematics = dynamics::free_body_kinematics();
  state.insert(body, VecX::Zero(6), VecX::Zero(6));
  state.insert(tool, (VecX(7) << 1, 0, 0, 0, 0, 0, 0).finished(), VecX::Zero(6));
  const auto text = [&](int dof) {
    const loop::NamedDirection d = loop::name_of(state.layout(), dof);
    return fmt::format("{} {} {}", d.block, d.node, d.axis);
  };
  EXPECT_EQ(text(5), "liver 1 z");
  EXPECT_EQ(text(7), "probe -1 rotation y");
  EXPECT_EQ(text(10), "probe -1 y");
  EXPECT_EQ(text(-1), " -1 ");
  EXPECT_EQ(text(12), " -1 ");
}

TEST(Run, AnInterruptEndsALongAdvanceAfterItsStep) {
  std::atomic<bool> stop{false};
  const auto world = faked(&stop, 3);
  loop::RunOptions options;
  options.duration_s = 1000.0;  // one period: held_block records nothing and touches nothing
  world->description.duration_s = 1000.0;
  options.stop = &stop;
  const loop::RunResult result = loop::run(*world, options);
  EXPECT_TRUE(result.stopped);
  EXPECT_TRUE(result.status.ok()) << "to be stopped is no failure";
  EXPECT_EQ(result.counters.steps, 3);
  EXPECT_EQ(result.time, 0.0) << "nothing of a broken period is kept";
}

}  // namespace
