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
  std::string method = "distance";  ///< of all contacts but those with obstacles; or "image"
  int threads = 1;
};

/// Wall times over the exchange periods of a run in which something touches [ms].
struct Spread {
  double least = 0.0, median = 0.0, p99 = 0.0;
};

/// What a period spends on contact, in its order; all but the last three are of images.  Passes and gather
/// are timed by the GPU's own clock.
enum class ContactStage {
  kSkins,     ///< positions of skins, and of rigid surfaces, as far as regions need them
  kRegions,   ///< bounds and pruning: which skin may touch, along which normal
  kFaces,     ///< faces in axes of their region, and its camera
  kUpload,    ///< what was made, or sent, of the surfaces for the GPU
  kPasses,    ///< both surfaces drawn
  kGather,    ///< both compared, and the pairs brought into one list
  kReadback,  ///< all else of the images: commands, fence, and the list handed out by region
  kGaps,      ///< gaps in double, and samples
  kRest,      ///< the rest of the query; of nearest points all of it
  kForces,    ///< of all samples, once, at the end of the period
  kTangent    ///< likewise
};
inline constexpr int kContactStages = 11;
inline constexpr int kQueryStages = 9;  ///< the first of them make up a query
std::string_view name_of(ContactStage stage);

/// What contact costs in an exchange period, and beside it the rest of the period (medians where nothing else
/// is said).
struct ContactBenchRow {
  ContactBenchVariant variant;
  std::string device;               ///< what made the images (device_of)
  bool device_is_software = false;  ///< images by a rasteriser on the processor
  int skin_vertices = 0, tetrahedra = 0;
  /// that were timed: those in which something touched, or all where nothing ever did
  int periods = 0;
  bool touches = false;  ///< in any period
  long samples = 0;      ///< median of a query
  double regions = 0.0;  ///< mean of a query, of contacts with proxies
  long images = 0;       ///< median number of a query
  Spread query;          ///< the whole query
  Spread to_forces;      ///< the same and the forces on nodes
  Spread period;         ///< the whole exchange period
  Spread step;           ///< the period without its query: the integrator's steps, and the tool's ticks
  std::array<Spread, kContactStages> stages;
  double linearise_ms = 0.0;  ///< of the contact for the tool's ticks, mean of all periods; 0 without a tool
  double solve_ms = 0.0;      ///< factorisation and solution of the period's steps
  double period_s = 0.0;      ///< simulated
  /// forces and tangent as a fused step takes them, in one pass; 0 where the contact's tangent is none that
  /// stands beside the pattern
  double assembly_ms = 0.0;
  double elements_ms = 0.0;  ///< fused assembly over the elements of the first body at the same states
  /// With friction, of the pairs whose tangent is symmetric, largest of the run: the friction that a step
  /// left out, and the friction [N].
  double left_out_n = 0.0, friction_n = 0.0;
  std::vector<Vec3> forces;  ///< sum over the first body's nodes after each period [N]

  const Spread& of(ContactStage stage) const { return stages[static_cast<std::size_t>(stage)]; }
  /// simulated time over median run time
  double real_time_factor() const { return period.median > 0.0 ? 1e3 * period_s / period.median : 0.0; }
};

/// What finds the gaps of a method: "processor, instruction set", or of "image" the GPU and its driver, by
/// the driver's own words.
struct ContactDevice {
  std::string name;
  bool software = false;  ///< of "image": a rasteriser on the processor
};
/// @throws Error for "image" where it cannot be opened, saying why
ContactDevice device_of(const std::string& method);

/// Runs the scene for its duration, one exchange period after the other.
/// @param stop  true: ends early, with what there is
/// @throws Error where the scene has no contact but with obstacles
ContactBenchRow bench_contact(scene::Description description, const ContactBenchVariant& variant,
                              const std::atomic<bool>* stop = nullptr);

/// The scene's first body alone, held and moved as there, with contact of its own skin only: what looking
/// for it costs where nothing touches.
scene::Description against_itself(scene::Description description);

/// Copies of the scene's first body in a row along x, each held as it is there and in contact with the next:
/// many contacts in one implicit solve.
scene::Description row_of_bodies(scene::Description description, int count, double spacing_m);

/// What friction 0.3 makes of a step, with the tangent's unsymmetric part left out and with it ("full").
struct FrictionPrice {
  double symmetric_ms = 0.0, full_ms = 0.0;
  double left_out = 0.0;  ///< largest friction that a step left out, over the largest friction
  /// Between the two runs, over the largest force: the largest difference of the force on the first body at
  /// the same time.
  double force_change = 0.0;
};

/// Contact by nearest points beside the rest of a step, as ratios of one run: medians of periods, one thread
/// [ms].
struct ContactCost {
  std::string scene;
  /// A step of the first body without contact or tool, with linear_rtol = 1e-3.  As all that is without
  /// contact it moves under its weight: at rest there is nothing to solve.
  double one_body_ms = 0.0;
  /// With the scene's tolerance: the sum of such steps of each body by itself, and a step of all together.
  double bodies_ms = 0.0, contact_free_ms = 0.0;
  ContactBenchRow row;
  FrictionPrice friction;  ///< zeros of a scene with a tool, and where nothing touches
};
ContactCost bench_contact_price(const scene::Description& description,
                                const std::atomic<bool>* stop = nullptr);

/// A rigid sphere pressed into a ball under a fine skin, as one query by nearest points sees it.
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
std::vector<ContactGrowthRow> bench_patch_growth(int skin_vertices, double factor, int count,
                                                 const std::atomic<bool>* stop = nullptr);

/// How the query's time grows with what `rows` differ in: a power.
struct ContactGrowth {
  std::string with;  ///< "skin" or "area"
  std::vector<ContactGrowthRow> rows;
  double exponent() const;  ///< NaN for fewer than two rows
};

/// All that `palpate bench contact` measures.
struct ContactBenchReport {
  struct Scene {
    std::string name;
    std::vector<ContactBenchRow> rows;
    /// Null where there is none.
    const ContactBenchRow* find(const std::string& method, int threads) const;
  };
  std::vector<Scene> scenes;
  std::vector<ContactCost> prices;
  std::vector<ContactGrowth> growth;
  std::string no_image;  ///< why "image" was left out; empty: it was not
};

/// What a figure of the report must keep.
struct ContactBar {
  std::string scene;  ///< empty: of no scene
  std::string what;
  double value = 0.0, bar = 0.0;
  bool at_least = false;                                                  ///< else at most
  bool is_met() const { return at_least ? value >= bar : value <= bar; }  ///< false for NaN
};
/// The bars of all that was measured, in the report's order; bars.cpp lists them.
std::vector<ContactBar> contact_bars(const ContactBenchReport& report);

/// With the bars, and the processor that all of it ran on.
std::string to_json(const ContactBenchReport& report);

}  // namespace palpate::bench
