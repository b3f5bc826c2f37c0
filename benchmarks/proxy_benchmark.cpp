// Two bumpy balls of 44,000 skin vertices on 10,000 tetrahedra and 60 proxies each, pressed together, and one
// touched by a small rigid ball. The reference is the work that proxies avoid: placing every vertex of the
// two skins once (SkinPlacedWhole). A ring pressed by the ball from inside its hole, as one hull and as
// parts.
#include <benchmark/benchmark.h>

#include <numeric>

#include "proxy/decompose.h"
#include "proxy/decompose_solid.h"
#include "proxy/pruner.h"
#include "proxy/shapes.h"
#include "proxy/tools.h"

using namespace palpate;

namespace {

const LayeredModel& head() {
  static const LayeredModel model = [] {
    LayeredModel out = bumpy_ball(1.0, 0.15, 66);
    out.proxies = proxy::decompose(out, {.count = 60});
    return out;
  }();
  return model;
}

const LayeredModel& rigid_ball() {
  static const LayeredModel model = [] {
    LayeredModel out;
    out.skin = mesh::sphere(0.2, 20);
    out.proxies = proxy::decompose(out, {.count = 1});
    return out;
  }();
  return model;
}

/// Returns the nodes of a head moved along x and slightly dented, differently at each of eight phases.
std::vector<Points> phases(double x) {
  std::vector<Points> out;
  for (int i = 0; i < 8; ++i) {
    Points nodes = head().tets.nodes;
    nodes.row(1) += 0.01 * (3.0 * nodes.row(0).array() + i).sin().matrix();
    nodes.row(0).array() += x + 0.002 * i;
    out.push_back(nodes);
  }
  return out;
}

void Embed(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(mesh::embed(head().tets, head().skin.vertices));
  state.counters["vertices"] = static_cast<double>(head().skin.vertices.cols());
  state.counters["tets"] = static_cast<double>(head().tets.tets.cols());
}

void Decompose(benchmark::State& state) {
  proxy::DecomposeReport report;
  for (auto _ : state)
    benchmark::DoNotOptimize(proxy::decompose(head(), {.count = static_cast<int>(state.range(0))}, &report));
  state.counters["outside_mm"] = 1e3 * report.largest_outside;
  state.counters["largest_gap_mm"] = 1e3 * report.largest_gap;
  state.counters["volume_ratio"] = report.hull_volume / report.skin_volume;
}

void SkinPlacedWhole(benchmark::State& state) {
  const auto nodes = phases(0.0);
  Points skin;
  std::size_t i = 0;
  for (auto _ : state)
    for (int body = 0; body < 2; ++body)
      mesh::evaluate(head().embedding, head().tets.tets, nodes[++i % nodes.size()], skin);
}

void UpdateProxies(benchmark::State& state) {
  proxy::ProxySet set(head(), {.follow = state.range(0) ? proxy::Follow::kRigid : proxy::Follow::kAffine});
  const auto nodes = phases(0.0);
  std::size_t i = 0;
  for (auto _ : state) set.update(nodes[++i % nodes.size()]);
  double inflation = 0.0;
  for (int p = 0; p < set.size(); ++p) inflation += 1e3 * set.state(p).inflation / set.size();
  state.counters["mean_inflation_mm"] = inflation;
}

void report(benchmark::State& state, const proxy::PruneCounts& counts, const proxy::ProxySet& a,
            const proxy::ProxySet& b) {
  const double queries = static_cast<double>(counts.queries);
  state.counters["pairs"] = static_cast<double>(counts.pairs);
  state.counters["after_boxes"] = static_cast<double>(counts.after_boxes) / queries;
  state.counters["after_hulls"] = static_cast<double>(counts.after_hulls) / queries;
  state.counters["patches_tested"] = static_cast<double>(counts.patches_tested) / queries;
  state.counters["regions"] = static_cast<double>(counts.regions) / queries;
  state.counters["faces_a_percent"] = 100.0 * static_cast<double>(counts.faces_a) / queries / a.face_count();
  state.counters["faces_b_percent"] = 100.0 * static_cast<double>(counts.faces_b) / queries / b.face_count();
  state.counters["largest_turn"] = counts.largest_rotation;
}

/// Times the updates of both bodies and the query.
void TwoHeads(benchmark::State& state) {
  proxy::ProxySet a(head()), b(head());
  proxy::Pruner pruner(a, b);
  const auto nodes_a = phases(0.0), nodes_b = phases(1.94);
  std::size_t i = 0;
  for (auto _ : state) {
    a.update(nodes_a[++i % nodes_a.size()]);
    b.update(nodes_b[i % nodes_b.size()]);
    benchmark::DoNotOptimize(pruner.query(0.005));
  }
  report(state, pruner.counts(), a, b);
}

void TwoHeadsQueryAlone(benchmark::State& state) {
  proxy::ProxySet a(head()), b(head());
  proxy::Pruner pruner(a, b);
  a.update(phases(0.0)[0]);
  b.update(phases(1.94)[0]);
  for (auto _ : state) benchmark::DoNotOptimize(pruner.query(0.005));
  report(state, pruner.counts(), a, b);
}

void HeadAndRigidBall(benchmark::State& state) {
  proxy::ProxySet a(head()), b(rigid_ball());
  proxy::Pruner pruner(a, b);
  const auto nodes = phases(0.0);
  std::size_t i = 0;
  for (auto _ : state) {
    a.update(nodes[++i % nodes.size()]);
    b.update(Pose{Quat::Identity(), Vec3(0.0, 0.3, 1.12 + 0.002 * static_cast<double>(i % 8))});
    benchmark::DoNotOptimize(pruner.query(0.005));
  }
  report(state, pruner.counts(), a, b);
}

constexpr double kTube = 0.3, kHole = 1.3;
const TriMesh& ring() {
  static const TriMesh surface = tools::torus(kHole + kTube, kTube, 120, 60);
  return surface;
}

/// Times the decomposition of a rigid tool into hulls during assembly.
void DecomposeRing(benchmark::State& state) {
  proxy::DecomposeReport report;
  std::size_t hulls = 0;
  for (auto _ : state)
    hulls = proxy::decompose_solid(ring(), {.count = static_cast<int>(state.range(0))}).size();
  proxy::decompose_solid(ring(), {.count = static_cast<int>(state.range(0))}, &report);
  state.counters["faces"] = static_cast<double>(ring().faces.cols());
  state.counters["hulls"] = static_cast<double>(hulls);
  state.counters["volume_ratio"] = report.hull_volume / report.skin_volume;
}
void RingSet(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(proxy::rigid_proxies(ring()));
}

void HeadInRing(benchmark::State& state) {
  proxy::ProxySet a(head()),
      b = proxy::rigid_proxies(
          ring(), {.count = static_cast<int>(state.range(0)), .tolerance = state.range(0) > 24 ? 0.0 : 0.02});
  proxy::Pruner pruner(a, b);
  const auto nodes = phases(0.0);
  std::size_t i = 0;
  for (auto _ : state) {
    a.update(nodes[++i % nodes.size()]);
    b.update(Pose{Quat::Identity(), Vec3(1.0 - kHole - 0.02 - 0.002 * static_cast<double>(i % 8), 0.0, 0.0)});
    benchmark::DoNotOptimize(pruner.query(0.005));
  }
  report(state, pruner.counts(), a, b);
  state.counters["hulls"] = b.size();
}

BENCHMARK(Embed)->Unit(benchmark::kMillisecond);
BENCHMARK(Decompose)->Arg(16)->Arg(60)->Unit(benchmark::kMillisecond);
BENCHMARK(SkinPlacedWhole)->Unit(benchmark::kMicrosecond);
BENCHMARK(UpdateProxies)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);
BENCHMARK(TwoHeads)->Unit(benchmark::kMicrosecond);
BENCHMARK(TwoHeadsQueryAlone)->Unit(benchmark::kMicrosecond);
BENCHMARK(HeadAndRigidBall)->Unit(benchmark::kMicrosecond);
BENCHMARK(DecomposeRing)->Arg(1)->Arg(8)->Arg(24)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK(RingSet)->Unit(benchmark::kMillisecond);
BENCHMARK(HeadInRing)->Arg(1)->Arg(8)->Arg(24)->Arg(64)->Unit(benchmark::kMicrosecond);

}  // namespace
