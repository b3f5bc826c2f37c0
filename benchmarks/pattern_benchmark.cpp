// Cost of a change of the nodes coupled by contact: one step of the beams S and M of `palpate bench fem`
// (E = 1e5, 10 ms, linearly implicit) while a patch of coupled pairs is at rest, and while it moves by one
// node per step, so that the matrix has a new pattern. The patch: 64 nodes of the beam's upper face, each
// coupled with 9 nodes of the other half, as if the beam were folded onto itself. pattern_ms: patterns of
// System and slots of the terms; symbolic_ms: the solver's analysis of a pattern; both per step. `ratio` is
// in the second row of each pair.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "core/clock.h"
#include "palpate/integrate/integrators.h"
#include "product/fem/beam.h"

namespace {

using namespace palpate;

/// Nodes of the upper face by their position along and across.
struct UpperFace {
  std::map<std::pair<int, int>, int> node;
  int along = 0, across = 0;
  UpperFace(const VecX& rest, int cells_along, int cells_across) : along(cells_along), across(cells_across) {
    const double cell = 1.0 / cells_along, top = 0.125;
    for (int i = 0; i < rest.size() / 3; ++i)
      if (const Vec3 x = rest.segment<3>(3 * i); x.z() > top - 0.1 * cell)
        node[{static_cast<int>(std::lround((x.x() + 0.5) / cell)),
              static_cast<int>(std::lround((x.y() + 0.125) * cells_across / 0.25))}] = i;
  }
};

/// Couples a patch with its mirror image about the beam's middle, with a zero tangent: the cost is due to the
/// pattern alone.
class Patch final : public dynamics::ForceTerm {
 public:
  Patch(const UpperFace& face, bool moves) : face_(face), moves_(moves) {}
  std::string_view name() const override { return "patch"; }
  dynamics::TermTraits traits() const override { return {.contact = true}; }
  void add_force(const dynamics::StateView&, VecX&) override {}
  void add_tangent(const dynamics::StateView&, double, double, dynamics::BorderedMatrix&) override {}
  void apply_tangent(const dynamics::StateView&, double, double, const VecX&, VecX&) override {}
  std::uint64_t pattern_version() const override { return static_cast<std::uint64_t>(at_); }
  void add_pattern(dynamics::PatternBuilder& pattern) const override {
    constexpr int kEdge = 8;
    const int first = face_.along / 8 + at_ % 3;  // Back and forth.
    for (int i = first; i < first + kEdge; ++i)
      for (int j = 0; j < kEdge; ++j)
        for (int di = -1; di <= 1; ++di)
          for (int dj = -1; dj <= 1; ++dj) {
            const auto own = face_.node.find({i, j}),
                       other = face_.node.find({face_.along - i + di, std::clamp(j + dj, 0, face_.across)});
            if (own != face_.node.end() && other != face_.node.end() && own->second != other->second)
              pattern.add_pair(own->second, other->second);
          }
  }
  void step() { at_ += moves_; }

 private:
  UpperFace face_;
  bool moves_;
  int at_ = 0;
};

double still_s = 0.0;

void Step(benchmark::State& state, int along, int across, const std::string& linear_solver, bool moves) {
  bench::Beam beam(along, across, 1e5);
  auto patch = std::make_shared<Patch>(UpperFace(beam.rest, along, across), moves);
  beam.system.add(std::static_pointer_cast<dynamics::ForceTerm>(patch));
  beam.system.prepare(beam.state.view());
  IntegratorSpec spec;
  spec.name = "linearly-implicit-euler";
  spec.step_s = 0.01;
  spec.linear_solver = linear_solver;
  spec.linear_rtol = 1e-6;
  const auto stepper = integrate::make_stepper(beam.system, beam.state, spec);
  const auto advance = [&] {
    patch->step();
    const auto result = stepper->advance_to(beam.state.time() + spec.step_s);
    if (!result.ok()) state.SkipWithError(result.message.c_str());
  };
  for (int i = 0; i < 3; ++i) advance();
  const auto before = stepper->counters();
  const double start = wall_seconds();
  for (auto _ : state) advance();
  const double each = 1.0 / static_cast<double>(state.iterations()), step_s = each * (wall_seconds() - start);
  const auto after = stepper->counters();
  const auto ms = [&](double from, double to) { return 1e3 * each * (to - from); };
  state.counters["nodes"] = static_cast<double>(beam.rest.size() / 3);
  state.counters["symbolic"] = each * static_cast<double>(after.solver.symbolic - before.solver.symbolic);
  state.counters["symbolic_ms"] = ms(before.solver.symbolic_s, after.solver.symbolic_s);
  state.counters["factor_ms"] = ms(before.solver.factor_s, after.solver.factor_s);
  state.counters["solve_ms"] = ms(before.solver.solve_s, after.solver.solve_s);
  state.counters["pattern_and_values_ms"] = ms(before.tangent_s, after.tangent_s);
  if (moves)
    state.counters["ratio"] = step_s / still_s;
  else
    still_s = step_s;
}

}  // namespace

int main(int argc, char** argv) {
  const struct {
    const char* name;
    int along, across;
  } sizes[] = {{"S", 36, 9}, {"M", 56, 13}};
  for (const auto& size : sizes)
    for (const char* solver : {"cholmod", "pcg", "pcg-single", "pcg-two-level"})
      for (const bool moves : {false, true})
        benchmark::RegisterBenchmark(
            (std::string(size.name) + "/" + solver + (moves ? "/moves" : "/still")).c_str(),
            [size, solver, moves](benchmark::State& state) {
              Step(state, size.along, size.across, solver, moves);
            })
            ->Unit(benchmark::kMillisecond)
            ->Iterations(12);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
