#include "experiments/compare/run.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <type_traits>

#include "core/archive_bytes.h"
#include "experiments/compare/task_process.h"
#include "loop/summary.h"
#include "palpate/experiments/compare.h"
#include "store/csv.h"
#include "store/study_columns.h"

using namespace palpate;

namespace {

/// Run in which every number is different, so that a swapped member shows: counts are whole, times are not.
compare::PointRun distinct() {
  compare::PointRun run;
  int next = 1000;
  loop::visit_counters(
      [&next]<class T>(const char*, T& value) {
        value = static_cast<T>(next++) + (std::is_integral_v<T> ? T(0) : T(0.125));
      },
      run.result);
  return run;
}

std::map<std::string, double> numbers_of(const loop::RunResult& result) {
  std::map<std::string, double> out;
  loop::visit_counters(
      [&out](const char* name, const auto& value) {
        EXPECT_TRUE(out.emplace(name, static_cast<double>(value)).second) << name << " twice";
      },
      result);
  return out;
}

class Folder {
 public:
  Folder()
      : path(std::filesystem::temp_directory_path() / ("palpate-run-archive-" + std::to_string(getpid()))) {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path path;
};

// Lists the names of the struct's members a second time: the archive must have every counter of a run.
TEST(RunArchive, VisitsEveryMember) {
  const compare::PointRun run = distinct();
  const dynamics::StepperCounters& c = run.result.counters;
  const dynamics::SolverCounters& s = c.solver;
  std::set<double> values;
  for (const long count : {c.steps,
                           c.rejected,
                           c.error_test_failures,
                           c.newton_failures,
                           c.newton_iterations,
                           c.force_evaluations,
                           c.tangent_evaluations,
                           c.reinits,
                           c.events,
                           c.indefinite,
                           c.projected,
                           c.unconverged,
                           c.rounding_limited,
                           c.lu,
                           c.kept_matrix_iterations,
                           c.definite_retries,
                           c.leaps,
                           c.halved_steps,
                           c.step_parts,
                           c.downhill,
                           c.clamped,
                           c.fast_steps,
                           s.symbolic,
                           s.orderings,
                           s.factorisations,
                           s.solves,
                           s.iterations,
                           s.lagged,
                           s.residual_checks,
                           s.refreshes,
                           run.result.periods,
                           run.result.ticks,
                           run.result.contact_queries,
                           run.result.limited_ticks,
                           run.result.outside_ticks,
                           run.result.rejected_ticks,
                           run.result.frozen_fallbacks,
                           run.result.sub_steps,
                           run.result.shortest_refreshes})
    values.insert(static_cast<double>(count));
  for (const double time :
       {c.force_s, c.tangent_s, s.symbolic_s, s.factor_s, s.solve_s, run.result.time, run.result.cpu_s,
        run.result.wall_s, run.result.query_s, run.result.linearise_s, run.result.tool_s})
    values.insert(time);
  EXPECT_EQ(values.size(), 50u);
  EXPECT_EQ(numbers_of(run.result).size(), values.size());
  EXPECT_GE(*values.begin(), 1000.0) << "a member that is not visited";
}

TEST(RunArchive, NothingIsLostFromTheRunToTheTable) {
  const Folder folder;
  compare::PointRun run = distinct();
  run.result.counters.solver.ordering = "METIS";
  run.result.counters.most_halvings = 6;
  run.result.tunnelled = {3, 0, 7};
  const std::map<std::string, double> all = numbers_of(run.result);

  const compare::PointRun without = restored<compare::PointRun>(archived(run));
  EXPECT_FALSE(without.result.energy);
  double next = 0.5;
  run.result.energy.emplace().time = 7.25;
  loop::visit_energies([&](const char*, double& value) { value = next++; }, *run.result.energy);
  const compare::PointRun sent = restored<compare::PointRun>(archived(run));
  ASSERT_TRUE(sent.result.energy);
  EXPECT_EQ(sent.result.energy->time, 7.25);
  next = 0.5;
  loop::visit_energies([&](const char* name, double value) { EXPECT_EQ(value, next++) << name; },
                       *sent.result.energy);
  EXPECT_EQ(numbers_of(sent.result), all);
  EXPECT_EQ(sent.result.counters.solver.ordering, "METIS");
  EXPECT_EQ(sent.result.counters.most_halvings, 6);
  EXPECT_EQ(sent.result.tunnelled, run.result.tunnelled);

  compare::ComparePoint point;
  point.status = compare::Status::kOk;
  point.result = sent.result;
  compare::Comparison comparison;
  comparison.scenes.emplace_back().points.push_back(point);
  comparison.scenes[0].restarts.push_back(point);
  compare::write(comparison, folder.path.string());
  for (const char* file : {"compare.csv", "restarts.csv"}) {
    const store::CsvTable table = store::read_csv((folder.path / file).string());
    ASSERT_EQ(table.rows.size(), 1u) << file;
    for (const auto& [name, value] : all) EXPECT_EQ(table.numbers(name).at(0), value) << file << ": " << name;
  }
}

TEST(RunArchive, ASummaryHoldsEveryNumberOfARun) {
  const loop::World world;
  const compare::PointRun run = distinct();
  const store::Summary summary = loop::summarise(world, run.result, 0.0);
  std::map<std::string, double> found;
  for (const store::SummarySection& section : summary.sections)
    if (section.name == "counts" || section.name == "timings")
      for (const auto& [name, value] : section.values)
        found[name] = std::holds_alternative<long long>(value)
                          ? static_cast<double>(std::get<long long>(value))
                          : std::get<double>(value);
  EXPECT_EQ(found.erase("assemble_s"), 1u);
  EXPECT_EQ(found, numbers_of(run.result));
}

TEST(RunArchive, SumsAndDifferencesHaveEveryCounter) {
  const dynamics::StepperCounters c = distinct().result.counters;
  dynamics::SolverCounters twice = c.solver;
  twice += c.solver;
  dynamics::visit_counters(
      [](const char* name, const auto& two, const auto& one) { EXPECT_EQ(two, 2 * one) << name; }, twice,
      c.solver);
  const dynamics::StepperCounters none = c - c;
  dynamics::visit_counters([](const char* name, const auto& value) { EXPECT_EQ(value, 0) << name; }, none);
}

TEST(RunArchive, ATrajectoryComesBackToTheBit) {
  compare::Run run;
  compare::Trajectory& t = run.trajectory;
  t.period_times = {0.1, 0.2};
  t.energies = {-0.0, 1e-300};
  t.tick_times = {0.05, 0.1, 0.15};
  t.positions = {(VecX(3) << 1.0, 2.0, 3.0).finished(), (VecX(3) << 4.0, 5.0, std::nan("")).finished()};
  t.device.resize(3);
  for (int i = 0; i < 3; ++i) t.device[i] = {Vec3(i, 0.1, 0.2), Vec3(0.3, i, 0.4)};
  t.node_weights = VecX::Constant(3, 0.7);
  t.start = VecX::Zero(3);
  t.bodies = {{0, 3}};
  run.setup_s = 0.25;
  const auto back = restored<compare::Run>(archived(run));
  const compare::Trajectory& b = back.trajectory;
  EXPECT_EQ(b.period_times, t.period_times);
  EXPECT_TRUE(std::signbit(b.energies[0]));
  EXPECT_EQ(b.energies, t.energies);
  EXPECT_EQ(b.tick_times, t.tick_times);
  ASSERT_EQ(b.positions.size(), 2u);
  EXPECT_EQ(b.positions[0], t.positions[0]);
  EXPECT_EQ(b.positions[1][1], 5.0);
  EXPECT_TRUE(std::isnan(b.positions[1][2]));
  ASSERT_EQ(b.device.size(), 3u);
  EXPECT_EQ(b.device[2].force, t.device[2].force);
  EXPECT_EQ(b.device[2].moment, t.device[2].moment);
  EXPECT_EQ(b.node_weights, t.node_weights);
  ASSERT_EQ(b.bodies.size(), 1u);
  EXPECT_EQ(b.bodies[0].size, 3);
  EXPECT_EQ(back.setup_s, 0.25);
  const std::string bytes = archived(run);
  EXPECT_THROW(restored<compare::Run>(bytes.substr(0, bytes.size() - 9)), Error);
}

}  // namespace
