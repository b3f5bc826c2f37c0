#include "product/fem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "palpate/core/error.h"
#include "product/fem/peak_memory.h"
#include "product/fem/stage_work.h"

namespace palpate::bench {
namespace {

MachineLimits machine() {
  MachineLimits m;
  m.gflop_s = 200.0;
  m.double_gflop_s = 100.0;
  m.bandwidths = {{1e6, 80.0, 40.0}, {1e8, 20.0, 10.0}};
  return m;
}

TEST(FemBench, BandwidthBetweenWorkingSetsIsLinearInTheirLogarithm) {
  EXPECT_DOUBLE_EQ(machine().read_gb_s(1e5), 80.0);
  EXPECT_NEAR(machine().read_gb_s(1e7), 50.0, 1e-12);
  EXPECT_NEAR(machine().write_gb_s(1e7), 25.0, 1e-12);
  EXPECT_DOUBLE_EQ(machine().write_gb_s(1e9), 10.0);
}

TEST(FemBench, LimitIsTheLongerOfBytesAndOperations) {
  const StageWork bytes{.read_bytes = 8e7, .written_bytes = 4e7, .double_flops = 1.0};
  EXPECT_NEAR(bytes.limit_ms(machine(), 1e6), 1.0 + 1.0, 1e-12);
  const StageWork operations{.read_bytes = 1.0, .single_flops = 2e8, .double_flops = 3e8};
  EXPECT_NEAR(operations.limit_ms(machine(), 1e6), 1.0 + 3.0, 1e-12);
}

TEST(FemBench, WorkGrowsWithTheMeshAndTheSolveWithItsIterations) {
  const StepCounts one{.nodes = 1e3, .tetrahedra = 4e3, .blocks = 1.3e4, .iterations = 10.0};
  const StepCounts ten{.nodes = 1e4, .tetrahedra = 4e4, .blocks = 1.3e5, .iterations = 20.0};
  const StepWork a = work_of(one), b = work_of(ten);
  EXPECT_NEAR(b.force.read_bytes / a.force.read_bytes, 10.0, 1e-12);
  EXPECT_NEAR(b.matrix.written_bytes / a.matrix.written_bytes, 10.0, 1e-12);
  EXPECT_NEAR(b.solve.read_bytes / a.solve.read_bytes, 20.0, 1e-12);
  EXPECT_NEAR(bytes_to_store(ten) / bytes_to_store(one), 10.0, 1e-12);
}

// Fused assembly over the elements computes deformation and rotation once, and has no matrix in double
// precision.
TEST(FemBench, FusedAssemblyHasLessToDo) {
  StepCounts counts{.nodes = 1e3, .tetrahedra = 4e3, .blocks = 1.3e4, .iterations = 10.0};
  const StepWork passes = work_of(counts);
  counts.fused = true;
  const StepWork one = work_of(counts);
  EXPECT_LT(one.force.double_flops + one.matrix.double_flops,
            passes.force.double_flops + passes.matrix.double_flops);
  EXPECT_GT(one.matrix.double_flops, passes.matrix.double_flops);
  EXPECT_EQ(one.matrix.written_bytes, 36.0 * 0.5 * (counts.blocks - counts.nodes) + 24.0 * counts.nodes)
      << "each pair of nodes once";
  EXPECT_EQ(passes.solve.read_bytes - one.solve.read_bytes, counts.iterations * (40.0 - 16.0) * counts.nodes)
      << "masses for diagonal blocks";
  EXPECT_LT(one.working_set, 0.7 * passes.working_set);
}

// With the matrix of an earlier step: a residual and no matrix; an iteration costs the same.
TEST(FemBench, ALaggedStepHasNoMatrix) {
  StepCounts counts{.nodes = 1e3, .tetrahedra = 4e3, .blocks = 1.3e4, .iterations = 10.0, .fused = true};
  const StepWork own = work_of(counts);
  counts.lagged = true;
  const StepWork lagged = work_of(counts);
  EXPECT_EQ(lagged.matrix.limit_ms(machine(), 1e6) + lagged.factor.limit_ms(machine(), 1e6), 0.0);
  EXPECT_LT(lagged.force.double_flops, own.matrix.double_flops);
  EXPECT_GT(lagged.force.double_flops, 0.5 * own.matrix.double_flops) << "rotations are most of it";
  EXPECT_EQ(lagged.solve.read_bytes, own.solve.read_bytes);
}

TEST(FemBench, EvaluationsOverTheElementsOneByOne) {
  const std::vector<ElementTiming> timings = time_elements({"here", 8, 2}, 0.0);
  ASSERT_EQ(timings.size(), 6u);
  for (const ElementTiming& t : timings) {
    EXPECT_EQ(t.size, "here");
    EXPECT_EQ(t.nodes, 81);
    EXPECT_EQ(t.tetrahedra, 160);
    EXPECT_GE(t.runs, 9);
    EXPECT_GT(t.least_ms, 0.0) << t.stage;
    EXPECT_LE(t.least_ms, t.median_ms) << t.stage;
    EXPECT_GT(element_work(t.stage, {.nodes = 81, .tetrahedra = 160, .blocks = 800}).limit_ms(machine(), 1e5),
              0.0)
        << t.stage;
  }
}

TEST(FemBench, WorkOfEvaluationsIsOfWhatTheyDo) {
  const StepCounts counts{.nodes = 1e3, .tetrahedra = 4e3, .blocks = 1.3e4};
  const auto work = [&](const char* stage) { return element_work(stage, counts); };
  EXPECT_GT(work("force, damped").double_flops, work("force").double_flops);
  EXPECT_GT(work("residual").double_flops, work("force").double_flops);
  EXPECT_GT(work("fused assembly").double_flops, work("residual").double_flops);
  EXPECT_GT(work("tangent, exact").double_flops, work("tangent, warped").double_flops);
  EXPECT_EQ(work("tangent, exact").read_bytes, work("tangent, warped").read_bytes);
  EXPECT_EQ(work("tangent, warped").written_bytes, 72.0 * counts.blocks);
  EXPECT_THROW(work("forces"), InternalError);
}

TEST(FemBench, ExponentOfAPowerLaw) {
  std::vector<FemBenchRow> rows(3);
  std::vector<const FemBenchRow*> members;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].nodes = static_cast<int>(1000 * std::pow(4, k));
    rows[k].solve_ms = 3e-4 * std::pow(rows[k].nodes, 1.25);
    members.push_back(&rows[k]);
  }
  EXPECT_NEAR(scaling_exponent(members, &FemBenchRow::solve_ms), 1.25, 1e-9);
  EXPECT_NEAR(scaling_exponent({{10.0, 3.0}, {100.0, 0.0}, {1000.0, 300.0}}), 1.0, 1e-12)
      << "what was not measured does not count";
  EXPECT_TRUE(std::isnan(scaling_exponent({{10.0, 3.0}})));
}

TEST(FemBench, PeakMemorySeesWhatWasGivenBack) {
  const PeakMemory memory;
  if (!std::isfinite(memory.bytes())) GTEST_SKIP() << "this system does not tell";
  {
    std::vector<double> v(std::size_t{4} << 20, 1.0);  // 32 MiB
    EXPECT_EQ(v.back(), 1.0);
  }
  EXPECT_GT(memory.bytes(), 31.0 * 1048576.0);
  EXPECT_LT(memory.bytes(), 40.0 * 1048576.0);
}

}  // namespace
}  // namespace palpate::bench
