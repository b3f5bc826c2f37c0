// Figures of a task, compared with a run that the test makes and observes.
#include "experiments/study/figures.h"

#include <gtest/gtest.h>

#include "experiments/compare/scenes.h"
#include "experiments/study/block.h"
#include "palpate/loop/load.h"
#include "palpate/loop/run.h"
#include "store/content_hash.h"

using namespace palpate;
using experiments::Status;

namespace {

const std::atomic<bool> kNever{false};

/// Returns the text of a figure; empty where there is none.
std::string text_of(const study::Columns& columns, const std::string& name) {
  for (const auto& [column, value] : columns)
    if (column == name) return value;
  return "";
}
double number_of(const study::Columns& columns, const std::string& name) {
  return std::stod(text_of(columns, name));
}

/// Records positions after every period, and the device's forces.
class Witness : public loop::Observer {
 public:
  void period(loop::World& world, double /*t*/) override { positions.push_back(world.state.q()); }
  void tick(const loop::TickRecord& record) override { ticks.push_back(record); }
  std::vector<VecX> positions;
  std::vector<loop::TickRecord> ticks;

  double displacement(std::size_t period) const {
    double out = 0.0;
    for (Eigen::Index i = 0; i < positions[0].size(); i += 3)
      out = std::max(out, (positions[period].segment<3>(i) - positions[0].segment<3>(i)).norm());
    return out;
  }
};

void add(store::ContentHash& hash, const VecX& v) {
  hash.add({reinterpret_cast<const char*>(v.data()), static_cast<std::size_t>(v.size()) * sizeof(double)});
}

}  // namespace

TEST(StudyFigures, AreThoseOfTheRun) {
  const auto d = loop::parse(study_scenes::kBlock + "[record]\nstate_period_s = 1e-3\nenergy = true\n",
                             "x.toml", {"scene.duration_s=0.03", "body.0.stiffness_damping_s=1e-5"});
  const auto world = loop::assemble(d);
  Witness witness;
  loop::RunOptions options;
  options.observers = {&witness};
  const loop::RunResult result = loop::run(*world, options);

  const study::SceneRun out = study::run_scene(d, 1, kNever);
  const study::Columns& figures = out.figures;
  EXPECT_EQ(out.status, Status::kOk);
  double largest = 0.0;
  for (std::size_t p = 0; p < witness.positions.size(); ++p)
    largest = std::max(largest, witness.displacement(p));
  EXPECT_EQ(number_of(figures, "largest_displacement_m"), largest);
  EXPECT_GT(largest, 1.2 * witness.displacement(witness.positions.size() - 1)) << "it swings back";
  EXPECT_EQ(number_of(figures, "steps"), result.counters.steps);
  EXPECT_EQ(number_of(figures, "simulated_s"), 0.03);
  EXPECT_GT(number_of(figures, "elastic_j"), 0.0);
  store::ContentHash hash;
  add(hash, world->state.q());
  add(hash, world->state.u());
  EXPECT_EQ(text_of(figures, "end_state"), hash.hex());
  EXPECT_GT(number_of(out.times, "loop_cpu_s"), 0.0);
  EXPECT_EQ(text_of(figures, "loop_cpu_s"), "") << "a time is no figure";
  EXPECT_EQ(text_of(figures, "peak_force_n"), "") << "there is no hand";
}

#ifdef PALPATE_HAS_TOOL
TEST(StudyFigures, OfAHandAreItsLargestForceAndWhen) {
  const auto d = compare_scenes::tool_alone(R"([[device.keyframe]]
time_s = 0.01
position_m = [0.004, 0.0, 0.05]
[[device.keyframe]]
time_s = 0.02
position_m = [0.0, 0.0, 0.05]
)");
  const auto world = loop::assemble(d);
  Witness witness;
  loop::RunOptions options;
  options.observers = {&witness};
  loop::run(*world, options);
  const auto peak = std::max_element(
      witness.ticks.begin(), witness.ticks.end(),
      [](const auto& a, const auto& b) { return a.device.force.norm() < b.device.force.norm(); });

  const study::Columns figures = study::run_scene(d, 1, kNever).figures;
  EXPECT_GT(peak->device.force.norm(), 0.1);
  EXPECT_LT(peak->time, 0.03) << "not at the end";
  EXPECT_EQ(number_of(figures, "peak_force_n"), peak->device.force.norm());
  EXPECT_EQ(number_of(figures, "peak_force_at_s"), peak->time);
  EXPECT_EQ(text_of(figures, "largest_displacement_m"), "") << "there is no body";
}
#endif
