#include <algorithm>
#include <cmath>
#include <vector>

#include "core/clock.h"
#include "core/huge_pages.h"
#include "palpate/core/workers.h"
#include "product/fem.h"

namespace palpate::bench {
namespace {

/// Working sets [bytes], and the time [s] for which each measurement is repeated.
constexpr std::size_t kSmallest = std::size_t{1} << 18, kLargest = std::size_t{1} << 28;
constexpr double kMeasureFor = 0.012;
constexpr int kLeastRepeats = 3;

/// Calls pass(k) for k = 0 ... count() - 1, all threads together.
template <class Pass>
void on_all_threads(Pass&& pass) {
  workers::for_each(
      workers::count(), [&](int k, int) { pass(k); }, workers::Order::kFromBothEnds);
}

/// Returns the best bandwidth of several passes of all threads over `bytes` [GB/s].
template <class Pass>
double fastest_gb_s(double bytes, double measure_for, Pass&& pass) {
  double best = 0.0;
  const double begin = wall_seconds();
  for (int r = 0; r < kLeastRepeats || wall_seconds() - begin < measure_for; ++r) {
    const double start = wall_seconds();
    on_all_threads(pass);
    best = std::max(best, 1e-9 * bytes / (wall_seconds() - start));
  }
  return best;
}

/// Returns the bounds of thread k's share of `count` numbers, in whole lines.
std::pair<std::size_t, std::size_t> share(std::size_t count, int k, int threads) {
  const std::size_t lines = count / 8, parts = static_cast<std::size_t>(threads);
  return {8 * (lines * static_cast<std::size_t>(k) / parts),
          8 * (lines * (static_cast<std::size_t>(k) + 1) / parts)};
}

typedef double Line __attribute__((vector_size(64)));
typedef double LineInMemory __attribute__((vector_size(64), may_alias, aligned(8)));

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
double
read_all(const double* from, std::size_t count) {
  Line sum[4] = {};
  for (std::size_t i = 0; i + 32 <= count; i += 32)
    for (std::size_t k = 0; k < 4; ++k) sum[k] += *reinterpret_cast<const LineInMemory*>(from + i + 8 * k);
  double total = 0.0;
  for (const Line& s : sum)
    for (int l = 0; l < 8; ++l) total += s[l];
  return total;
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
void write_all(double* to, std::size_t count, double value) {
  const Line all = Line{} + value;
  for (std::size_t i = 0; i + 8 <= count; i += 8) *reinterpret_cast<LineInMemory*>(to + i) = all;
}

/// Returns the bandwidth of copying one half of `memory` to the other; read and write counted.
double copy_gb_s(std::vector<double>& memory, std::size_t bytes, double measure_for) {
  const std::size_t half = bytes / sizeof(double) / 2;
  return fastest_gb_s(static_cast<double>(2 * half * sizeof(double)), measure_for, [&](int k) {
    const auto [first, last] = share(half, k, workers::count());
    std::copy(memory.data() + first, memory.data() + last, memory.data() + half + first);
  });
}

/// Performs multiply-adds in registers, with enough chains to hide their latency.
template <class Pack, int kWidth>
[[gnu::always_inline]] inline double multiply_add(double seed, int rounds) {
  constexpr int kChains = 8;
  Pack sum[kChains];
  for (int c = 0; c < kChains; ++c)
    for (int l = 0; l < kWidth; ++l) sum[c][l] = static_cast<decltype(sum[c][l] + 0)>(seed + c + l);
  const Pack a = sum[0] * 0 + static_cast<decltype(sum[0][0] + 0)>(0.9999),
             b = sum[0] * 0 + static_cast<decltype(sum[0][0] + 0)>(1e-3);
  for (int r = 0; r < rounds; ++r)
    for (int c = 0; c < kChains; ++c) sum[c] = sum[c] * a + b;
  double total = 0.0;
  for (int c = 0; c < kChains; ++c)
    for (int l = 0; l < kWidth; ++l) total += static_cast<double>(sum[c][l]);
  return total;
}
constexpr int kRounds = 1000000, kOperations = 2 * 8;  // Per round and lane.

typedef float Floats __attribute__((vector_size(64)));
#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
double
multiply_add_floats(double seed) {
  return multiply_add<Floats, 16>(seed, kRounds);
}
#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
double
multiply_add_doubles(double seed) {
  return multiply_add<Line, 8>(seed, kRounds);
}

double gflop_s(double (*work)(double), int lanes) {
  std::vector<double> sums(static_cast<std::size_t>(workers::count()));
  double best = 0.0;
  for (int r = 0; r < 4; ++r) {
    const double start = wall_seconds();
    on_all_threads([&](int k) { sums[static_cast<std::size_t>(k)] = work(static_cast<double>(r)); });
    const double operations = static_cast<double>(kOperations) * lanes * kRounds * workers::count();
    if (sums[0] > 0.0) best = std::max(best, 1e-9 * operations / (wall_seconds() - start));
  }
  return best;
}

/// Interpolates between the measured working sets, linearly in the logarithm of their size.
double at_size(const std::vector<Bandwidth>& measured, double bytes, double Bandwidth::*kind) {
  if (bytes <= measured.front().bytes) return measured.front().*kind;
  for (std::size_t i = 1; i < measured.size(); ++i) {
    if (bytes > measured[i].bytes) continue;
    const double part =
        std::log(bytes / measured[i - 1].bytes) / std::log(measured[i].bytes / measured[i - 1].bytes);
    return (1.0 - part) * (measured[i - 1].*kind) + part * (measured[i].*kind);
  }
  return measured.back().*kind;
}

}  // namespace

double MachineLimits::read_gb_s(double working_set) const {
  return at_size(bandwidths, working_set, &Bandwidth::read_gb_s);
}
double MachineLimits::write_gb_s(double working_set) const {
  return at_size(bandwidths, working_set, &Bandwidth::write_gb_s);
}

MachineLimits measure_limits(int threads) {
  const workers::Count of_threads(threads);
  MachineLimits out;
  out.threads = threads;
  std::vector<double> memory(kLargest / sizeof(double), 1.0), sums(static_cast<std::size_t>(threads));
  prefer_huge_pages(memory);
  for (std::size_t bytes = kSmallest; bytes <= kLargest; bytes *= 2) {
    const std::size_t count = bytes / sizeof(double);
    Bandwidth b;
    b.bytes = static_cast<double>(bytes);
    b.read_gb_s = fastest_gb_s(b.bytes, kMeasureFor, [&](int k) {
      const auto [first, last] = share(count, k, threads);
      sums[static_cast<std::size_t>(k)] += read_all(memory.data() + first, last - first);
    });
    b.write_gb_s = fastest_gb_s(b.bytes, kMeasureFor, [&](int k) {
      const auto [first, last] = share(count, k, threads);
      write_all(memory.data() + first, last - first, 1.0);
    });
    out.bandwidths.push_back(b);
  }
  out.small_copy_gb_s = copy_gb_s(memory, std::size_t{16} << 20, 0.05);
  out.large_copy_gb_s = copy_gb_s(memory, std::size_t{128} << 20, 0.2);
  out.gflop_s = gflop_s(multiply_add_floats, 16);
  out.double_gflop_s = gflop_s(multiply_add_doubles, 8);
  return out;
}

}  // namespace palpate::bench
