#pragma once
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "palpate/contact/query_stages.h"
#include "palpate/contact/query_view.h"
#include "palpate/contact/sample.h"
#include "palpate/contact/sum_error.h"
#include "palpate/core/archive.h"
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/state.h"

namespace palpate::proxy {
struct PruneCounts;
}  // namespace palpate::proxy

namespace palpate::contact {

/// Properties of a SampleSource, fixed at its construction.
struct SourceTraits {
  std::string name;  ///< Name of the method, as in `contact.method` of a scene, or of the obstacle's type.
  /// True: the samples are re-evaluated at each state between two queries, like nearest points. False, as for
  /// samples at vertices: their gaps are linear in the positions.
  bool follows = false;
  /// True: the force has a kink where a sample opens or closes, so that a root finder should stop there.
  bool has_events = true;
};

/// Results of a source other than its samples. Sources that have nothing to report leave the defaults.
struct SourceReport {
  /// Number of vertices that tunnelled: they passed through the shape or the other body between two queries
  /// and lay outside at both, so that no contact force acted on them.
  long tunnelled = 0;
  /// Time after the last query at which the next one is due [s]: at the velocities of the last query, no skin
  /// penetrates farther by then than half of the thickness of the body that it touches.
  double safe_time = HUGE_VAL;
  /// Number of times that the safe time of a region was shorter than the time to the next query.
  long fast_regions = 0;
  /// Number of regions that kept the normal of the previous query, because they are so deep, or so much
  /// enclosed, that the skins do not determine the direction out.
  long normals_kept = 0;
  const proxy::PruneCounts* pruning = nullptr;  ///< Pruning before the images; null without proxies.
  const SumError* sum_error = nullptr;          ///< Quadrature error of the forces; null: not estimated.
  const QueryStages* stages = nullptr;          ///< Wall time by stage; null without images.
  /// Picture data of the last query; null without images, and before keep_view().
  const QueryView* view = nullptr;
};

/// Source of the contact samples of one pair, evaluated at the current state (the slow query).
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  const SourceTraits& traits() const { return traits_; }  ///< Returns the properties of the source.
  /// Appends the samples of the pair at `state`, including candidates with a small positive gap.
  virtual void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) = 0;
  /// Evaluates the samples of the last query at another state, in the same order: exact gaps, normals, points
  /// and areas. Called where SourceTraits::follows is true.
  virtual void follow(const dynamics::StateView&, std::span<ContactSample>) {}
  /// Returns the indices of the material points that the last query's samples represent, ascending; an index
  /// denotes the same point at every query. Empty where samples do not represent material points.
  virtual std::span<const int> material_points() const { return {}; }
  /// Adds the node pairs that the samples may couple: nodes of the faces of each surface, and across two soft
  /// bodies.
  virtual void add_pattern(dynamics::PatternBuilder& pattern) const = 0;
  /// Returns a counter that increases whenever add_pattern() would add other pairs.
  virtual std::uint64_t pattern_version() const { return 0; }
  /// Returns the results of the last query, and the counts since construction. Its pointers are valid as long
  /// as the source.
  virtual SourceReport report() const { return {}; }
  /// Keeps the data that pictures need, from the next query on. By default nothing is kept.
  virtual void keep_view() {}
  /// Saves or restores the state that the next query takes from earlier ones, and the counters.
  virtual void archive(Archive&) {}

 protected:
  /// @param traits  name and properties, which never change
  explicit SampleSource(SourceTraits traits) : traits_(std::move(traits)) {}

 private:
  SourceTraits traits_;
};

}  // namespace palpate::contact
