#pragma once
#include <memory>
#include <span>
#include <vector>

#include "contact/coupled_nodes.h"
#include "contact/image_region.h"
#include "contact/look_back.h"

namespace palpate::contact {

/// What the sources in image space share: two sides, which may be the same, and what their samples couple.
/// Side a is soft; the normal points from b to a.
///
/// A query goes in phases: the regions are collected; round by round each one that is still open asks for an
/// image, a backend answers, and the regions look at it; in the end they make their samples.  One region
/// after the other goes through all rounds, or, where the backend would rather have many requests at once,
/// all regions of all sources together (answer_together).
class ImageSource : public SampleSource {
 public:
  ImageSource(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b, const ImageOptions& options);
  std::string_view name() const override { return backend_name(context_.options.backend); }
  void add_pattern(dynamics::PatternBuilder& pattern) const override;
  std::uint64_t pattern_version() const override;
  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) final;
  void query(const dynamics::StateView& state, SampleCells& samples);  ///< the same, appended
  const QueryStages* stages() const final { return &context_.stages; }
  const SumError* sum_error() const final { return &context_.sum_error; }
  void keep_view() final { context_.view.emplace(); }
  const QueryView* view() const final { return context_.view ? &*context_.view : nullptr; }
  long tunnelled() const final { return look_back_.count(); }
  double safe_time() const final { return context_.safe_time; }
  long fast_regions() const final { return context_.fast_regions; }
  ImageSource* in_images() final { return this; }
  bool asks_together() const { return context_.options.backend == DepthBackend::kGpu; }

  std::string fallback() const final { return fallback_; }
  void archive(Archive& a) override;

  /// The phases of a query, for the sources whose requests are answered together.
  void open(const dynamics::StateView& state);               ///< collects the regions
  void collect(std::vector<DepthRequest*>& requests) const;  ///< appends what open regions ask for
  void take();                                               ///< all of these were answered
  void close(SampleCells& samples);                          ///< appends samples
  DepthImage& image();                                       ///< made when it is first asked for
  bool comes_new() const { return !prepared_; }
  void prepare(DepthImage& image);  ///< DepthImage::prepare() for its sides.  @pre open
  bool may_fall_back() const { return context_.options.or_cpu; }
  void fall_back(const std::string& why);  ///< to the processor, for good
  /// Its share of the image's last answer, which took so long [s].
  void add_image_times(double seconds, const ImageTimes& times, double share);
  /// Scratch of answer_together, which its first source keeps.
  struct AskedTogether {
    std::vector<DepthRequest*> requests;
    std::vector<std::size_t> counts;  ///< of requests, by source
  };
  AskedTogether& asked_together() { return asked_together_; }

 protected:
  virtual std::size_t find_regions(const dynamics::StateView& state) = 0;  ///< how many there are now
  /// Faces of either side, of which some may have met since the sides were kept; empty where none can have
  /// gone through.  @return how thick the thinner side is [m]
  virtual double find_met(std::vector<int>& faces_a, std::vector<int>& faces_b) = 0;
  /// Whether a vertex of one face may meet another face.
  virtual bool may_meet(int, int) const { return true; }
  virtual std::unique_ptr<ImageRegion> make_region() = 0;
  /// Starts on region number `index`, in an object that another one may have used.
  virtual void start(ImageRegion& region, std::size_t index) = 0;
  /// Whether its regions go through their rounds together, for what they decide together after each.
  virtual bool settles() const { return false; }
  virtual void settle(std::size_t /*open*/) {}  ///< the first regions are open, and have had their answers
  ImageRegion& region(std::size_t place);
  ImageRegion& add_region() { return region(open_++); }  ///< another one that is open, to be started

  RegionContext context_;

 private:
  std::size_t begin(const dynamics::StateView& state);
  void end(const SampleCells& samples, std::size_t first_cell);

  LookBack look_back_;
  bool prepared_ = false;
  std::unique_ptr<DepthImage> image_;
  std::string fallback_;
  SampleCells cells_;  ///< scratch
  AskedTogether asked_together_;
  std::vector<std::unique_ptr<ImageRegion>> regions_;
  std::size_t open_ = 0;          ///< of `regions_`, in the query under way
  mutable CoupledNodes coupled_;  // of two soft sides; the pattern is made when it is asked for
  NodeNeighbours neighbours_a_, neighbours_b_;
  std::uint64_t sides_version() const;  // grows with what either side couples by itself
  std::uint64_t counted_ = 0;           // the one that `coupled_` was made for
};

/// The rounds of all these sources, which are open and of one backend, by the image of the first.
void answer_together(std::span<ImageSource* const> sources);

/// One region: both surfaces whole.
std::unique_ptr<SampleSource> make_whole_source(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b,
                                                const ImageOptions& options);
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
