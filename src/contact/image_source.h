#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "contact/coupled_nodes.h"
#include "contact/image_region.h"
#include "contact/look_back.h"

namespace palpate::contact {

/// Finds contact of two sides in images; how the regions are found is its children's.  Side a is soft; the
/// normal points from b to a.
///
/// A query collects the regions, asks for their images, all at once, and makes samples of what they show
/// (Galoppo et al. 2007, section 4).
class ImageSource : public SampleSource {
 public:
  ImageSource(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b, const ImageOptions& options);
  std::string_view name() const override { return "image"; }
  void add_pattern(dynamics::PatternBuilder& pattern) const override;
  std::uint64_t pattern_version() const override;
  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) final;
  const QueryStages* stages() const final { return &context_.stages; }
  void keep_view() final { context_.view.emplace(); }
  const QueryView* view() const final { return context_.view ? &*context_.view : nullptr; }
  long tunnelled() const final { return look_back_.count(); }
  double safe_time() const final { return context_.safe_time; }
  long fast_regions() const final { return context_.fast_regions; }
  void archive(Archive& a) override;

 protected:
  /// Appends the regions of the state; their faces are there until the next query.
  virtual void find_regions(const dynamics::StateView& state, std::vector<RegionPlane>& out) = 0;
  /// Faces of either side, of which some may have met since the sides were kept; empty where none can have
  /// gone through.  @return how thick the thinner side is [m]
  virtual double find_met(std::vector<int>& faces_a, std::vector<int>& faces_b) = 0;
  /// Region `number` of find_regions() was seen, and presses.
  virtual void take_pressing(std::size_t number) = 0;

  RegionContext context_;

 private:
  void answer();
  std::uint64_t sides_version() const;  // grows with what either side couples by itself
  void couple();

  LookBack look_back_;
  std::unique_ptr<DepthImage> image_;  ///< made in the first query
  std::vector<RegionPlane> planes_;
  std::vector<std::unique_ptr<ImageRegion>> regions_;  ///< the first planes_.size() are of the last query
  std::vector<DepthRequest*> requests_;                ///< scratch
  std::vector<CoupledNodes::Joint> joints_;            // of two soft sides
  mutable CoupledNodes coupled_;                       // the pattern is made when it is asked for
  NodeNeighbours neighbours_a_, neighbours_b_;
  std::uint64_t counted_ = 0;  // the sides_version() that `coupled_` was made for
};

/// One region: both surfaces whole.
std::unique_ptr<SampleSource> make_whole_source(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b,
                                                const ImageOptions& options);
std::unique_ptr<SampleSource> make_pruned_source(std::shared_ptr<ImageSide> a,
                                                 std::shared_ptr<proxy::ProxySet> proxies_a,
                                                 std::shared_ptr<ImageSide> b,
                                                 std::shared_ptr<proxy::ProxySet> proxies_b,
                                                 const ImageOptions& options);

}  // namespace palpate::contact
