#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "contact/cell_builder.h"
#include "contact/depth_image.h"
#include "contact/facing.h"
#include "contact/quadrature.h"
#include "contact/vertex_rule.h"
#include "palpate/contact/sources.h"

namespace palpate::contact {

/// What the regions of one source share.
struct RegionContext {
  std::shared_ptr<ImageSide> a, b;
  ImageOptions options;
  QueryStages stages;
  SumError sum_error;
  std::optional<QueryView> view = {};   ///< of the last query, where somebody asked
  double candidate_gap = 0.0;           ///< what counts as near without any motion [m]
  double safe_time = 0.0;               ///< as SampleSource::safe_time, of the query under way
  long fast_regions = 0;                ///< as SampleSource::fast_regions
  double volume = 0.0, variance = 0.0;  ///< of its regions [m^3], [m^6]

  // scratch of the region that is being worked on
  ExactLines lines;
  VertexRule vertices;
  DepthGrid grid;
  std::vector<Eigen::Vector2d> middles;  ///< of doubtful pixels
  std::vector<FacePair> by_lines;
  std::vector<Hit> merged;
  std::vector<std::uint32_t> united;  ///< doubtful pixels
  CellBuilder cells;

  bool of_one_body() const { return a == b; }
  /// A region's part of `safe_time`.  @param thickness  of the thinner side [m]
  void take_speed(double apart, double approach, double thickness);
  bool samples_vertices() const { return options.samples == SampleRule::kVertex; }
  Eigen::Vector2d shift() const { return {options.shift_u, options.shift_v}; }
  /// Pixels of the first image of a region: all, or as many as tell which the wanted error needs.
  int first_pixels() const;
};

/// A contact region on its way from triangles to samples.  It asks for an image, looks at the answer, may ask
/// for another one, and in the end has samples; who answers, and with which regions at once, is not its
/// affair.
class ImageRegion {
 public:
  explicit ImageRegion(RegionContext& context) : context_(context) {}
  virtual ~ImageRegion() = default;
  DepthRequest* wanted() { return asks_ ? &request_ : nullptr; }  ///< null: nothing more
  virtual void take() = 0;                                        ///< `wanted` was answered
  virtual void append_samples(SampleCells& samples) = 0;          ///< @pre nothing more is wanted

 protected:
  void forget();  ///< before another region
  /// What the patches are, which stand along `axes_`.
  void set_sources(const PatchSource& a, const PatchSource& b) {
    request_.from_a = a;
    request_.from_b = b;
  }
  /// Asks for an image; false, and no hits, where that would see nothing.
  bool ask(const ContactCamera& camera);
  /// Fills `hits_` at the pixels: all that is nearer than the candidate gap, by the image, and by exact lines
  /// at pixels with layers or walls, of which an image shows too little, and where it rounded to a neighbour.
  void see();
  /// After an image: asks for the one that the wanted error needs, or that shows triangles one by one to the
  /// vertices, of the part of the window where something was seen.  False where the image will do.
  bool ask_finer(const ContactWindow& window);
  /// The same in two steps, for an image along other axes: `next_along` them while the first image's hits are
  /// there, and when the patches stand along them `ask_next`, which always asks, for pixels that are no
  /// coarser than those of a first image.
  struct Extent {
    Eigen::Vector2d low, high;
  };
  struct NextImage {
    Extent seen;   ///< [m]
    double pixel;  ///< edge that the wanted error needs; 0: unknown [m]
  };
  Extent seen_along(const ContactAxes& axes) const;  ///< @pre something was seen
  NextImage next_along(const ContactAxes& axes);     ///< @pre something was seen
  bool ask_next(const ContactWindow& window, const NextImage& next);
  /// After the image that counts: what `samples` asks for in `hits_`, with what the pixels err counted.
  void finish();
  /// `hits_` as samples; after finish.  @param face_a, face_b  of a patch's face, that of the whole side
  template <class OfA, class OfB>
  void append_hits(SampleCells& samples, OfA face_a, OfB face_b) {
    const double area = context_.samples_vertices() ? -1.0 : camera().pixel * camera().pixel;
    context_.cells.start(axes_, *context_.a, *context_.b, area, samples);
    for (const Hit& hit : hits_) context_.cells.add(hit.at, face_a(hit.face_a), face_b(hit.face_b), hit.area);
    context_.cells.finish();
  }
  /// The grid behind `hits_`, for pictures, where somebody asked; after finish.
  void keep_view();
  const ContactCamera& camera() const { return request_.camera; }  ///< of the last image

  RegionContext& context_;
  double candidate_gap_ = 0.0;  ///< of this region [m]
  /// Part of its contact region's volume that is its own: image_region.cpp derives what it may err.
  double share_ = 1.0;
  ContactAxes axes_;
  Patch a_, b_;
  std::vector<Hit> hits_;

 private:
  double wanted_pixel();
  double pixel_for(const ContactWindow& part, double by_hits) const;
  ContactCamera camera_of_at_most(const ContactWindow& part, double pixel) const;
  bool take_pair(const FacePair& pair);
  void doubt_layers();
  void ask_lines();
  void count_error();
  const QuadratureEstimate& estimate();  ///< of pixels in `hits_`, made once

  bool asks_ = false;
  DepthRequest request_;
  FacePlanes planes_a_, planes_b_;
  std::vector<std::uint32_t> doubtful_;  ///< pixels
  std::vector<std::uint32_t> layers_;    ///< scratch of doubt_layers
  std::optional<QuadratureEstimate> estimate_;
};

}  // namespace palpate::contact
