// Pruning on the paper's models: cost of a query (proxies, bounds, pairs, patches, regions) and number of
// faces passed to the rasteriser, compared with the true contact patch. The models are read from the folder
// that PALPATE_MODELS specifies, otherwise from the folder of the tests' fixture (`ctest -R proxy.model`).
// The reference is the work that proxies avoid: placing every vertex of the skins once.
#include <benchmark/benchmark.h>

#include <cstdlib>

#include "proxy/touch_cases.h"

namespace {

using palpate::Points;

std::string folder() {
  const char* given = std::getenv("PALPATE_MODELS");
  return given ? given : PALPATE_MODELS_FOLDER;
}

void add_counters(benchmark::State& state, const touch::Bodies& bodies,
                  const palpate::proxy::PruneCounts& counts) {
  const double queries = static_cast<double>(counts.queries), faces = bodies.a.face_count();
  const auto each = [&](long n) { return static_cast<double>(n) / queries; };
  state.counters["pairs"] = static_cast<double>(counts.pairs);
  state.counters["boxes_tested"] = each(counts.boxes_tested);
  state.counters["after_boxes"] = each(counts.after_boxes);
  state.counters["after_hulls"] = each(counts.after_hulls);
  state.counters["patches_tested"] = each(counts.patches_tested);
  state.counters["patches_kept"] = each(counts.patches_kept);
  state.counters["regions"] = each(counts.regions);
  state.counters["handed_a_pct"] = 100.0 * each(counts.faces_a) / faces;
  state.counters["handed_b_pct"] = 100.0 * each(counts.faces_b) / bodies.b.face_count();
}

/// Computes the true contact patch by brute force at three phases, and times it.
void true_patch(benchmark::State& state, const touch::Case& c) {
  double a = 0.0, b = 0.0;
  const int phases[] = {0, touch::kPhases / 4, touch::kPhases / 2};
  for (auto _ : state)
    for (const int phase : phases) {
      const touch::Skins skins(c, phase);
      a += static_cast<double>(touch::true_patch(c.a.skin.faces, skins.a, c.b.skin.faces, skins.b).size());
      b += static_cast<double>(touch::true_patch(c.b.skin.faces, skins.b, c.a.skin.faces, skins.a).size());
    }
  const double runs = 3.0 * static_cast<double>(state.iterations());
  state.counters["true_a_pct"] = 100.0 * a / runs / static_cast<double>(c.a.skin.faces.cols());
  state.counters["true_b_pct"] = 100.0 * b / runs / static_cast<double>(c.b.skin.faces.cols());
}

void query(benchmark::State& state, const touch::Case& c) {
  touch::Bodies bodies(c);
  palpate::proxy::Pruner pruner(bodies.a, bodies.b);
  int i = 0;
  for (auto _ : state) {
    bodies.update(i = (i + 1) % touch::kPhases);
    benchmark::DoNotOptimize(pruner.query(c.gap));
  }
  add_counters(state, bodies, pruner.counts());
}

/// Times a query with proxies swept by velocities, with a moving into b within 10 ms, and with a check of the
/// path since the previous query.
void swept_query(benchmark::State& state, const touch::Case& c, double speed) {
  constexpr double kTime = 0.01;
  touch::Bodies bodies(c);
  palpate::proxy::Pruner pruner(bodies.a, bodies.b);
  const Points velocities = (-speed * c.inward).replicate(1, c.a.tets.nodes.cols());
  const Points ways = kTime * velocities;
  std::vector<int> met_a, met_b;
  int i = 0;
  for (auto _ : state) {
    bodies.update(i = (i + 1) % touch::kPhases);
    bodies.a.set_motion(ways);
    pruner.met_on_the_way(met_a, met_b);
    bodies.a.set_motion(velocities);
    benchmark::DoNotOptimize(pruner.query(c.gap, kTime));
  }
  add_counters(state, bodies, pruner.counts());
}
void slow_query(benchmark::State& state, const touch::Case& c) { swept_query(state, c, 0.1); }
void fast_query(benchmark::State& state, const touch::Case& c) { swept_query(state, c, 3.0); }

void update_alone(benchmark::State& state, const touch::Case& c) {
  touch::Bodies bodies(c);
  int i = 0;
  for (auto _ : state) bodies.update(i = (i + 1) % touch::kPhases);
}

void place_whole_skin(benchmark::State& state, const touch::Case& c) {
  Points skin;
  const Points nodes = c.nodes_a(0);
  for (auto _ : state)
    for (int body = 0; body < 1 + c.b_is_soft(); ++body)
      palpate::mesh::evaluate(c.a.embedding, c.a.tets.tets, nodes, skin);
}

}  // namespace

int main(int argc, char** argv) {
  const touch::Case cases[] = {touch::pumpkins(folder()), touch::head(folder()), touch::human(folder())};
  const char* names[] = {"pumpkins", "head", "human"};
  for (int i = 0; i < 3; ++i) {
    const auto add = [&](const std::string& what, void (*run)(benchmark::State&, const touch::Case&)) {
      benchmark::RegisterBenchmark((std::string(names[i]) + "/" + what).c_str(),
                                   [run, &c = cases[i]](benchmark::State& state) { run(state, c); })
          ->Unit(benchmark::kMicrosecond);
    };
    add("query", query);
    add("query_swept_0.1_m_s", slow_query);
    add("query_swept_3_m_s", fast_query);
    add("update_alone", update_alone);
    add("whole_skin_placed", place_whole_skin);
    add("true_patch", true_patch);
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
