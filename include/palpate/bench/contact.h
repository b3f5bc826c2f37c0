#pragma once
#include <atomic>
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::bench {

/// One way to find the gaps of a scene.
struct ContactBenchVariant {
  std::string method;  ///< of all contacts but those with obstacles: "cpu", "gpu", "exact"
  int pixels = 0;      ///< along the longer edge of each image; 0: as the scene wants them
  int threads = 1;
};

/// Wall times over the exchange periods of a run in which something touches [ms].
struct Spread {
  double least = 0.0, median = 0.0, p99 = 0.0;
};

/// What contact costs in an exchange period, stage by stage (medians), and beside it the rest of the period.
struct ContactBenchRow {
  ContactBenchVariant variant;
  int skin_vertices = 0, tetrahedra = 0;
  int periods = 0;       ///< in which something touched, of those timed
  long samples = 0;      ///< median of a query
  long images = 0;       ///< median number of a query
  Spread query, period;  ///< the whole query; the whole exchange period
  double positions_ms = 0.0, regions_ms = 0.0, patches_ms = 0.0, images_ms = 0.0, gaps_ms = 0.0;
  double grouping_ms = 0.0;  ///< rest of the query: groups, checks
  /// forces and tangent of all samples at the end of the period, once each
  double force_ms = 0.0, tangent_ms = 0.0;
  double linearise_ms = 0.0;  ///< of the contact for the tool's ticks, mean of all periods; 0 without a tool
  double solve_ms = 0.0;      ///< factorisation and solution of the period's steps
  double period_s = 0.0;      ///< simulated
  /// simulated time over median run time
  double real_time_factor() const { return period.median > 0.0 ? 1e3 * period_s / period.median : 0.0; }
};

/// Runs the scene for its duration, one exchange period after the other.
/// @param stop  true: ends early, with what there is
/// @throws Error where the scene has no contact in image space, or nothing ever touches
ContactBenchRow bench_contact(scene::Description description, const ContactBenchVariant& variant,
                              const std::atomic<bool>* stop = nullptr);

}  // namespace palpate::bench
