#pragma once
#include <array>
#include <atomic>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/scene/description.h"

namespace palpate::bench {

/// One way to find the gaps of a scene.
struct ContactBenchVariant {
  std::string method = "distance";  ///< Method of all contacts except with obstacles; or "image".
  int threads = 1;
};

/// Wall times [ms] over the exchange periods of a run with contact.
struct Spread {
  double least = 0.0, median = 0.0, p99 = 0.0;
};

/// Stages of contact in a period, in order; all but the last three apply to images only. Passes and gather
/// are timed by the GPU's clock.
enum class ContactStage {
  kSkins,     ///< Positions of skins, and of rigid surfaces, as far as regions need them.
  kRegions,   ///< Bounds and pruning: which skin may touch, along which normal.
  kFaces,     ///< Faces in the axes of their region, and its camera.
  kUpload,    ///< Surface data created or sent for the GPU.
  kPasses,    ///< Rendering of both surfaces.
  kGather,    ///< Comparison of both, and collection of the pairs in one list.
  kReadback,  ///< Other work of images: commands, fence, and distribution of the list by region.
  kGaps,      ///< Gaps in double precision, and samples.
  kRest,      ///< Rest of the query; for nearest points all of it.
  kForces,    ///< Forces of all samples, once, at the end of the period.
  kTangent    ///< Tangent of all samples, once, at the end of the period.
};
inline constexpr int kContactStages = 11;
inline constexpr int kQueryStages = 9;  ///< The first of them, which make up a query.
std::string_view name_of(ContactStage stage);

/// Cost of contact in an exchange period, and of the rest of the period (medians unless stated otherwise).
struct ContactBenchRow {
  ContactBenchVariant variant;
  std::string device;               ///< Device that rendered the images (device_of).
  bool device_is_software = false;  ///< Images by a software rasteriser.
  int skin_vertices = 0, tetrahedra = 0;
  /// Number of timed periods: those with contact, or all if there never was any.
  int periods = 0;
  bool touches = false;  ///< Whether there was contact in any period.
  long samples = 0;      ///< Median per query.
  double regions = 0.0;  ///< Mean per query, for contacts with proxies.
  long images = 0;       ///< Median number per query.
  Spread query;          ///< The whole query.
  Spread to_forces;      ///< Query and forces on nodes.
  Spread period;         ///< The whole exchange period.
  Spread step;           ///< Period without its query: the integrator's steps and the tool's ticks.
  std::array<Spread, kContactStages> stages;
  /// Linearisation of the contact for the tool's ticks, mean of all periods; 0 without a tool.
  double linearise_ms = 0.0;
  double solve_ms = 0.0;  ///< Factorisation and solution of the period's steps.
  double period_s = 0.0;  ///< Simulated time.
  /// Forces and tangent as a fused step computes them, in one pass; 0 if the contact's tangent cannot be
  /// stored outside the pattern.
  double assembly_ms = 0.0;
  double elements_ms = 0.0;  ///< Fused assembly over the elements of the first body at the same states.
  /// With friction, for the pairs with a symmetric tangent, largest of the run: friction omitted by a step,
  /// and friction [N].
  double left_out_n = 0.0, friction_n = 0.0;
  std::vector<Vec3> forces;  ///< Sum over the first body's nodes after each period [N].

  const Spread& of(ContactStage stage) const { return stages[static_cast<std::size_t>(stage)]; }
  /// Returns simulated time over median run time.
  double real_time_factor() const { return period.median > 0.0 ? 1e3 * period_s / period.median : 0.0; }
};

/// Device that finds the gaps of a method: "processor, instruction set", or for "image" the GPU and its
/// driver, as named by the driver.
struct ContactDevice {
  std::string name;
  bool software = false;  ///< For "image": a software rasteriser.
};
/// Returns the device of a method. @throws Error for "image" if it cannot be opened, with the reason
ContactDevice device_of(const std::string& method);

/// Runs the scene for its duration, one exchange period after the other.
/// @param description scene to run
/// @param variant method and number of threads
/// @param stop true: ends early, with the results so far
/// @throws Error if the scene has contacts only with obstacles
ContactBenchRow bench_contact(scene::Description description, const ContactBenchVariant& variant,
                              const std::atomic<bool>* stop = nullptr);

/// Returns the scene's first body alone, held and moved as there, with self-contact of its skin only: the
/// cost of contact detection without contact.
scene::Description against_itself(scene::Description description);

/// Returns copies of the scene's first body in a row along x, each held as in the scene and in contact with
/// the next: many contacts in one implicit solve.
scene::Description row_of_bodies(scene::Description description, int count, double spacing_m);

/// Effect of friction 0.3 on a step, without and with the unsymmetric part of the tangent ("full").
struct FrictionPrice {
  double symmetric_ms = 0.0, full_ms = 0.0;
  double left_out = 0.0;  ///< Largest friction omitted by a step, over the largest friction.
  /// Largest difference between the two runs' forces on the first body at the same time, over the largest
  /// force.
  double force_change = 0.0;
};

/// Contact by nearest points compared with the rest of a step, as ratios of one run: medians of periods, one
/// thread [ms].
struct ContactCost {
  std::string scene;
  /// Step of the first body without contact or tool, with linear_rtol = 1e-3. Like all runs without contact,
  /// it moves under its weight: at rest there is nothing to solve.
  double one_body_ms = 0.0;
  /// With the scene's tolerance: the sum of such steps over each body alone, and a step of all together.
  double bodies_ms = 0.0, contact_free_ms = 0.0;
  ContactBenchRow row;
  FrictionPrice friction;  ///< Zero for a scene with a tool, and without contact.
};
ContactCost bench_contact_price(const scene::Description& description,
                                const std::atomic<bool>* stop = nullptr);

/// Rigid sphere pressed into a ball under a fine skin, measured by one query by nearest points.
struct ContactGrowthRow {
  int skin_vertices = 0;
  double area_m2 = 0.0;  ///< Area of the contact region, from the samples: sum of areas where they overlap.
  long samples = 0;
  Spread query;  ///< [ms]
};
/// Measures the same contact region, with the same radius and under the same triangles, on skins with
/// increasing numbers of vertices: balls with a growing radius, about 10,000 tetrahedra each.
std::vector<ContactGrowthRow> bench_skin_growth(const std::vector<int>& skin_vertices,
                                                const std::atomic<bool>* stop = nullptr);
/// Measures one skin with contact regions whose area grows by `factor` in `count` steps.
std::vector<ContactGrowthRow> bench_patch_growth(int skin_vertices, double factor, int count,
                                                 const std::atomic<bool>* stop = nullptr);

/// Growth of the query's time with the quantity that differs between `rows`: a power.
struct ContactGrowth {
  std::string with;  ///< "skin" or "area".
  std::vector<ContactGrowthRow> rows;
  double exponent() const;  ///< NaN for fewer than two rows.
};

/// All measurements of `palpate bench contact`.
struct ContactBenchReport {
  struct Scene {
    std::string name;
    std::vector<ContactBenchRow> rows;
    /// Returns null if there is none.
    const ContactBenchRow* find(const std::string& method, int threads) const;
  };
  std::vector<Scene> scenes;
  std::vector<ContactCost> prices;
  std::vector<ContactGrowth> growth;
  std::string no_image;  ///< Reason why "image" was skipped; empty: it was not.
};

/// Acceptance limit of a figure in the report.
struct ContactBar {
  std::string scene;  ///< Empty: not specific to a scene.
  std::string what;
  double value = 0.0, bar = 0.0;
  bool at_least = false;                                                  ///< Otherwise at most.
  bool is_met() const { return at_least ? value >= bar : value <= bar; }  ///< False for NaN.
};
/// Returns the acceptance limits of all measurements, in the report's order; bars.cpp lists them.
std::vector<ContactBar> contact_bars(const ContactBenchReport& report);

/// Returns the report with its acceptance limits and the processor that it was measured on.
std::string to_json(const ContactBenchReport& report);

}  // namespace palpate::bench
