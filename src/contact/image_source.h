#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "contact/coupled_nodes.h"
#include "contact/depth_image.h"
#include "contact/facing.h"
#include "palpate/contact/sources.h"

namespace palpate::contact {

/// What the sources in image space share: two sides, which may be the same, an image, and what their samples
/// couple.  Side a is soft; the normal points from b to a.
class ImageSource : public SampleSource {
 public:
  ImageSource(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b, const ImageOptions& options);
  std::string_view name() const override { return backend_name(options_.backend); }
  void add_pattern(dynamics::PatternBuilder& pattern) const override;
  std::uint64_t pattern_version() const override;
  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) final;
  const QueryStages* stages() const final { return &stages_; }

 protected:
  virtual void look(std::vector<ContactSample>& samples) = 0;  ///< at the sides as they are
  /// Fills `pairs_` by the image, which is made when something is to be seen.
  void find_pairs(const Patch& a, const Patch& b, const ContactCamera& camera);
  bool of_one_body() const { return a_ == b_; }

  std::shared_ptr<ImageSide> a_, b_;
  ImageOptions options_;
  std::vector<PixelPair> pairs_;
  QueryStages stages_;

 private:
  std::unique_ptr<DepthImage> image_;
  CoupledNodes coupled_;  // of two soft sides
  NodeNeighbours neighbours_a_, neighbours_b_;
  std::uint64_t sides_version() const;  // grows with what either side couples by itself
  std::uint64_t counted_ = 0;           // the one that `coupled_` was made for
};

std::unique_ptr<SampleSource> make_pruned_source(std::shared_ptr<ImageSide> a,
                                                 std::shared_ptr<proxy::ProxySet> proxies_a,
                                                 std::shared_ptr<ImageSide> b,
                                                 std::shared_ptr<proxy::ProxySet> proxies_b,
                                                 const ImageOptions& options);
/// One side against itself, its bones' regions against each other.
std::unique_ptr<SampleSource> make_pruned_source(std::shared_ptr<ImageSide> side,
                                                 std::shared_ptr<proxy::ProxySet> proxies, Points rest_nodes,
                                                 const ImageOptions& options);

}  // namespace palpate::contact
