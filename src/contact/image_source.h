#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "contact/coupled_nodes.h"
#include "contact/depth_image.h"
#include "contact/facing.h"
#include "contact/quadrature.h"
#include "contact/vertex_rule.h"
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
  /// Fills `hits_` at the pixels by the image, which is made when something is to be seen: all that is nearer
  /// than the candidate gap.
  void see(const Patch& a, const Patch& b, const ContactCamera& camera);
  /// After the image that counts: pixels with layers or walls, of which an image shows too little, by exact
  /// lines; then what `samples` asks for in `hits_`, with what the pixels err counted.
  void finish(const Patch& a, const Patch& b, const ContactCamera& camera);
  /// Pixels of the first image of a region: all, or as many as tell which the wanted error needs.
  int first_pixels() const;
  /// After an image of `camera`: the camera that the wanted error needs, or that shows triangles one by one
  /// to the vertices, of the part of the window where something was seen.  False where the image will do.
  bool needs_finer(const Patch& a, const Patch& b, const ContactWindow& window, const ContactCamera& camera,
                   ContactCamera& finer);
  bool of_one_body() const { return a_ == b_; }
  Eigen::Vector2d shift() const { return {options_.shift_u, options_.shift_v}; }

  std::shared_ptr<ImageSide> a_, b_;
  ImageOptions options_;
  double candidate_gap_ = 0.0;  ///< of the query under way [m]
  std::vector<Hit> hits_;
  QueryStages stages_;

 private:
  bool take_pair(const FacePair& pair, const Patch& a, const Patch& b, const ContactCamera& camera);
  void ask_lines(const Patch& a, const Patch& b, const ContactCamera& camera);
  bool samples_vertices() const { return options_.samples == SampleRule::kVertex; }
  void count_error(const ContactCamera& camera);
  const QuadratureEstimate& estimate_of(const ContactCamera& camera);  ///< of pixels in `hits_`, made once

  std::unique_ptr<DepthImage> image_;
  std::vector<FacePair> pairs_;
  FacePlanes planes_a_, planes_b_;
  ExactLines lines_;
  std::vector<std::uint32_t> layered_, doubtful_;  ///< pixels
  std::vector<Eigen::Vector2d> middles_;           ///< of doubtful pixels
  std::vector<FacePair> by_lines_;
  VertexRule vertices_;
  DepthGrid grid_;
  std::optional<QuadratureEstimate> estimate_;
  double volume_ = 0.0, variance_ = 0.0;  ///< of the query's regions [m^3], [m^6]
  CoupledNodes coupled_;                  // of two soft sides
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
