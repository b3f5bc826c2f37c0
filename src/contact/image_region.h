#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "contact/coupled_nodes.h"
#include "contact/depth_image.h"
#include "contact/facing.h"
#include "contact/region_mesh.h"
#include "contact/vertex_rule.h"
#include "palpate/contact/sources.h"

namespace palpate::contact {

/// What the regions of one source share.
struct RegionContext {
  std::shared_ptr<ImageSide> a, b;
  ImageOptions options;
  QueryStages stages;
  std::optional<QueryView> view = {};  ///< of the last query, where somebody asked
  double safe_time = 0.0;              ///< as SampleSource::safe_time, of the query under way
  long fast_regions = 0;               ///< as SampleSource::fast_regions

  VertexRule vertices;
  std::vector<int> local_a, local_b;  ///< scratch of RegionMesh

  /// A region's part of `safe_time`.  @param thickness  of the thinner side [m]
  void take_speed(double apart, double approach, double thickness);
};

/// The plane that a region is looked at along, and the faces that may take part.
struct RegionPlane {
  Vec3 origin = Vec3::Zero(), normal = Vec3::UnitZ();  ///< from b to a
  double candidate_gap = 0.0;                          ///< [m]
  const std::vector<int>*faces_a = nullptr, *faces_b = nullptr;
};

/// A contact region on its way from triangles to samples: start(), the answer to what it has asked for,
/// see(), append_samples().
class ImageRegion {
 public:
  explicit ImageRegion(RegionContext& context) : context_(context) {}
  void start(const RegionPlane& plane);
  DepthRequest* wanted() { return asks_ ? &request_ : nullptr; }  ///< null: there is nothing to see
  /// Gathers the image at the vertices.  @pre asked
  void see();
  /// @param joints  of two soft sides: what carries the samples; else null
  void append_samples(std::vector<ContactSample>& samples, std::vector<CoupledNodes::Joint>* joints);
  bool presses() const;  ///< whether something overlaps in it

 private:
  const ContactCamera& camera() const { return request_.camera; }
  void keep_view();

  RegionContext& context_;
  double candidate_gap_ = 0.0;  ///< of this region [m]
  ContactAxes axes_;
  RegionMesh mesh_a_, mesh_b_;
  Patch a_, b_;
  std::vector<Hit> hits_;
  bool asks_ = false;
  DepthRequest request_;
  FacePlanes planes_a_, planes_b_;
};

}  // namespace palpate::contact
