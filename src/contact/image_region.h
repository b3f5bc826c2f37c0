#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "contact/coupled_nodes.h"
#include "contact/depth_image.h"
#include "contact/image_options.h"
#include "contact/region_mesh.h"
#include "contact/triangle_pair_gap.h"
#include "contact/vertex_rule.h"
#include "palpate/contact/query_stages.h"
#include "palpate/contact/query_view.h"

namespace palpate::contact {

/// State shared by the regions of one source.
struct RegionContext {
  std::shared_ptr<ImageSide> a, b;
  ImageOptions options;
  QueryStages stages = {};
  std::optional<QueryView> view = {};  ///< Picture data of the last query, if requested.
  double safe_time = 0.0;              ///< As SourceReport::safe_time, for the present query.
  long fast_regions = 0;               ///< As SourceReport::fast_regions.

  VertexRule vertices = {};
  std::vector<int> local_a = {}, local_b = {};  ///< Scratch of RegionMesh.

  /// Updates `safe_time` and `fast_regions` with one region.
  /// @param apart  gap [m]  @param approach  rate of decrease of the gap [m/s]  @param thickness of  the
  ///   thinner side [m]
  void take_speed(double apart, double approach, double thickness);
};

/// Plane along whose normal a region is seen, and the faces that may take part.
struct RegionPlane {
  Vec3 origin = Vec3::Zero(), normal = Vec3::UnitZ();  ///< Origin [m] and unit normal from b to a.
  double candidate_gap = 0.0;                          ///< Candidate gap [m].
  const std::vector<int>*faces_a = nullptr, *faces_b = nullptr;
};

/// Contact region, evaluated from triangles to samples in this order: start(), result of the requested image,
/// see(), append_samples().
class ImageRegion {
 public:
  explicit ImageRegion(RegionContext& context) : context_(context) {}
  /// Gathers the faces of the region, fits its camera, and prepares its image request.
  void start(const RegionPlane& plane);
  /// Returns the requested image; null: nothing to see.
  DepthRequest* requested() { return asks_ ? &request_ : nullptr; }
  /// Evaluates the image at the vertices. @pre the request was answered
  void see();
  /// Appends the samples of the region.
  /// @param joints  receives the carriers of the samples for two soft sides; otherwise null
  void append_samples(std::vector<ContactSample>& samples, std::vector<CoupledNodes::Joint>* joints);
  bool presses() const;  ///< Returns whether any sample overlaps.

 private:
  const ContactCamera& camera() const { return request_.camera; }
  void keep_view();

  RegionContext& context_;
  double candidate_gap_ = 0.0;  ///< Candidate gap of this region [m].
  ContactAxes axes_;
  RegionMesh mesh_a_, mesh_b_;
  Patch a_, b_;
  std::vector<Hit> hits_;
  bool asks_ = false;
  DepthRequest request_;
  FacePlanes planes_a_, planes_b_;
};

}  // namespace palpate::contact
