#include <algorithm>
#include <vector>

#include "palpate/core/clock.h"
#include "palpate/core/team.h"
#include "palpate/study/fem_bench.h"

namespace palpate::study {
namespace {

/// Best of several copies of `bytes` a thread group shares [GB/s], read and write counted.
double copy_gb_s(Team& team, std::size_t bytes) {
  const std::size_t count = bytes / sizeof(double);
  std::vector<double> from(count, 1.0), to(count, 0.0);
  double best = 0.0;
  const int repeats = std::max(3, static_cast<int>(4e8 / static_cast<double>(bytes)));
  for (int r = 0; r < repeats; ++r) {
    const double start = wall_seconds();
    team.run([&](int k) {
      const std::size_t parts = static_cast<std::size_t>(team.size()), first = count * static_cast<std::size_t>(k) / parts, last = count * (static_cast<std::size_t>(k) + 1) / parts;
      std::copy(from.begin() + static_cast<std::ptrdiff_t>(first), from.begin() + static_cast<std::ptrdiff_t>(last), to.begin() + static_cast<std::ptrdiff_t>(first));
    });
    best = std::max(best, 2e-9 * static_cast<double>(bytes) / (wall_seconds() - start));
    from[static_cast<std::size_t>(r) % count] += to[count / 2];  // the copies are used
  }
  return best;
}

typedef float Lanes __attribute__((vector_size(64)));
constexpr int kChains = 8, kRounds = 2000000;

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
float multiply_add(float seed) {
  Lanes sum[kChains];
  for (int c = 0; c < kChains; ++c)
    for (int l = 0; l < 16; ++l) sum[c][l] = seed + static_cast<float>(c + l);
  const Lanes a = sum[0] * 0.0f + 0.9999f, b = sum[0] * 0.0f + 1e-3f;
  for (int r = 0; r < kRounds; ++r)
    for (int c = 0; c < kChains; ++c) sum[c] = sum[c] * a + b;
  float total = 0.0f;
  for (int c = 0; c < kChains; ++c)
    for (int l = 0; l < 16; ++l) total += sum[c][l];
  return total;
}

}  // namespace

MachineLimits measure_limits(int threads) {
  Team team(threads);
  MachineLimits out;
  out.threads = threads;
  out.small_copy_gb_s = copy_gb_s(team, 8u << 20);
  out.large_copy_gb_s = copy_gb_s(team, 64u << 20);
  std::vector<float> sums(static_cast<std::size_t>(threads));
  for (int r = 0; r < 3; ++r) {
    const double start = wall_seconds();
    team.run([&](int k) { sums[static_cast<std::size_t>(k)] = multiply_add(static_cast<float>(r)); });
    const double flops = 2.0 * 16 * kChains * static_cast<double>(kRounds) * threads;
    if (sums[0] > 0.0f) out.gflop_s = std::max(out.gflop_s, 1e-9 * flops / (wall_seconds() - start));
  }
  return out;
}

}  // namespace palpate::study
