#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "contact/coupled_sides.h"
#include "contact/image_region.h"
#include "contact/tunnelling_monitor.h"
#include "palpate/contact/sample_source.h"

namespace palpate::contact {

/// Image-space contact of two sides; derived classes find the regions. Side a is soft; the normal points from
/// b to a.
///
/// A query collects the regions, requests all their images at once, and makes samples from them (Galoppo et
/// al. 2007, section 4).
class ImageSource : public SampleSource {
 public:
  ImageSource(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b, const ImageOptions& options);
  void add_pattern(dynamics::PatternBuilder& pattern) const override { coupled_.add_pattern(pattern); }
  std::uint64_t pattern_version() const override { return coupled_.version(); }
  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) final;
  SourceReport report() const override;
  void keep_view() final { context_.view.emplace(); }
  void archive(Archive& a) override;

 protected:
  /// Appends the regions at a state; their faces are valid until the next query.
  virtual void find_regions(const dynamics::StateView& state, std::vector<RegionPlane>& out) = 0;
  /// Collects the faces of either side that may have come into contact since the sides were kept; empty where
  /// tunnelling is impossible. @return thickness of the thinner side [m]
  virtual double collect_candidate_faces(std::vector<int>& faces_a, std::vector<int>& faces_b) = 0;
  /// Notifies that region `number` of find_regions() was evaluated and presses.
  virtual void take_pressing(std::size_t number) = 0;

  RegionContext context_;

 private:
  void answer();

  TunnellingMonitor tunnelling_;
  std::unique_ptr<DepthImage> image_;  ///< Created in the first query.
  std::vector<RegionPlane> planes_;
  std::vector<std::unique_ptr<ImageRegion>> regions_;  ///< The first planes_.size() belong to the last query.
  std::vector<DepthRequest*> requests_;                ///< Scratch.
  std::vector<CoupledNodes::Joint> joints_;            // Two soft sides only.
  CoupledSides coupled_;
};

/// Makes a source with one region that contains both surfaces entirely.
std::unique_ptr<SampleSource> make_whole_source(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b,
                                                const ImageOptions& options);
/// Makes a source whose regions are found by convex proxies.
std::unique_ptr<SampleSource> make_pruned_source(std::shared_ptr<ImageSide> a,
                                                 std::shared_ptr<proxy::ProxySet> proxies_a,
                                                 std::shared_ptr<ImageSide> b,
                                                 std::shared_ptr<proxy::ProxySet> proxies_b,
                                                 const ImageOptions& options);

}  // namespace palpate::contact
