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
  /// that were timed: those in which something touched, or all where nothing ever did
  int periods = 0;
  bool touches = false;  ///< in any period
  long samples = 0;      ///< median of a query
  double regions = 0.0;  ///< mean of a query, of contacts with proxies
  long images = 0;       ///< median number of a query
  Spread query, period;  ///< the whole query; the whole exchange period
  Spread step;           ///< the period without its query: the integrator's steps, and the tool's ticks
  double positions_ms = 0.0, regions_ms = 0.0, patches_ms = 0.0, images_ms = 0.0, gaps_ms = 0.0;
  double grouping_ms = 0.0;  ///< rest of the query: groups, checks
  /// forces and tangent of all samples at the end of the period, once each
  double force_ms = 0.0, tangent_ms = 0.0;
  double linearise_ms = 0.0;  ///< of the contact for the tool's ticks, mean of all periods; 0 without a tool
  double solve_ms = 0.0;      ///< factorisation and solution of the period's steps
  double period_s = 0.0;      ///< simulated
  /// forces and tangent as a fused step takes them, in one pass; 0 where the contact's tangent is none that
  /// stands beside the pattern
  double assembly_ms = 0.0;
  double elements_ms = 0.0;  ///< fused assembly over the elements of the first body at the same states
  double query_bytes = 0.0;  ///< median of what a query must read and write (query_bytes() of contact_work.h)
  /// simulated time over median run time
  double real_time_factor() const { return period.median > 0.0 ? 1e3 * period_s / period.median : 0.0; }
};

/// Runs the scene for its duration, one exchange period after the other.
/// @param stop  true: ends early, with what there is
/// @throws Error where the scene has no contact in image space
ContactBenchRow bench_contact(scene::Description description, const ContactBenchVariant& variant,
                              const std::atomic<bool>* stop = nullptr);

/// The scene's first body alone, held and moved as there, with contact of its own skin only: what looking
/// for it costs where nothing touches.
scene::Description against_itself(scene::Description description);

/// Copies of the scene's first body in a row along x, each held as it is there and in contact with the next:
/// many contact regions in one implicit solve.
scene::Description row_of_bodies(scene::Description description, int count, double spacing_m);

/// Contact beside the rest of a step, as ratios of one run: medians of periods, one thread, the processor's
/// image with as many pixels as the scene wants [ms].
struct ContactPrice {
  ContactBenchRow contact;
  /// A step of the first body without contact or tool, with linear_rtol = 1e-3.  As all that is without
  /// contact it moves under its weight: at rest there is nothing to solve.
  double one_body_ms = 0.0;
  /// With the scene's tolerance: the sum of such steps of each body by itself, and a step of all together.
  double bodies_ms = 0.0, contact_free_ms = 0.0;
  double friction_ms = 0.0;  ///< a step of the scene with friction 0.3; 0 of a scene with a tool
};
ContactPrice bench_contact_price(const scene::Description& description,
                                 const std::atomic<bool>* stop = nullptr);

/// A rigid sphere pressed into a ball under a fine skin, as one query sees it.
struct ContactGrowthRow {
  int skin_vertices = 0;
  double area_m2 = 0.0;  ///< of the contact region, from the samples: sum of areas where they overlap
  long samples = 0;
  Spread query;  ///< [ms]
};
/// The same contact region, of the same radius and under the same triangles, on skins of more and more
/// vertices: balls of a growing radius, about 10,000 tetrahedra each.
std::vector<ContactGrowthRow> bench_skin_growth(const std::vector<int>& skin_vertices,
                                                const std::atomic<bool>* stop = nullptr);
/// One skin and contact regions of an area that grows by `factor` in `count` steps.
/// @param pixels  along the longer edge of the image; 0: as many as an error of 1e-3 wants
std::vector<ContactGrowthRow> bench_patch_growth(int skin_vertices, double factor, int count, int pixels,
                                                 const std::atomic<bool>* stop = nullptr);

}  // namespace palpate::bench
