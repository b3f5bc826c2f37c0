#include "contact/image_region.h"

#include <algorithm>
#include <cmath>

#include "contact/safe_time.h"
#include "core/clock.h"

namespace palpate::contact {
void RegionContext::take_speed(double apart, double approach, double thickness) {
  const double time = time_to_middle(apart, -approach, thickness);
  safe_time = std::min(safe_time, time);
  fast_regions += time < options.look_ahead;
}

void ImageRegion::start(const RegionPlane& plane) {
  hits_.clear();
  candidate_gap_ = plane.candidate_gap;
  axes_ = ContactAxes(plane.origin, plane.normal);
  {
    const ScopedTimer timer(context_.stages.positions_s);
    mesh_a_.take(*context_.a, *plane.faces_a, context_.local_a);
    mesh_b_.take(*context_.b, *plane.faces_b, context_.local_b);
  }
  const ScopedTimer timer(context_.stages.patches_s);
  axes_.to_axes(mesh_a_.vertices(), a_.uvw);
  axes_.to_axes(mesh_b_.vertices(), b_.uvw);
  a_.faces = &mesh_a_.faces();
  b_.faces = &mesh_b_.faces();
  const ImageOptions& options = context_.options;
  request_.camera =
      fit_camera(a_, b_, candidate_gap_, options.pixels, Eigen::Vector2d(options.shift_u, options.shift_v));
  asks_ = camera().sees_something();
  request_.a = &a_;
  request_.b = &b_;
  request_.candidate_gap = candidate_gap_;
  request_.axes = axes_;
  request_.from_a = {context_.a.get(), mesh_a_.surface_faces()};
  request_.from_b = {context_.b.get(), mesh_b_.surface_faces()};
}

void ImageRegion::see() {
  ++context_.stages.images;
  context_.stages.pixels += static_cast<long>(camera().width) * camera().height;
  context_.stages.pairs += static_cast<long>(request_.pairs.size());
  context_.stages.vertices += static_cast<long>(a_.uvw.cols() + b_.uvw.cols());
  context_.stages.faces += static_cast<long>(a_.visible.size() + b_.visible.size());
  const ScopedTimer timer(context_.stages.gaps_s);
  planes_a_.start(a_);
  planes_b_.start(b_);
  if (context_.view) keep_view();
  const VertexRule::Region region{.a = a_,
                                  .b = b_,
                                  .camera = camera(),
                                  .planes_a = planes_a_,
                                  .planes_b = planes_b_,
                                  .candidate_gap = candidate_gap_,
                                  .both_sides = context_.b->soft() != nullptr};
  context_.vertices.find(region, request_.pairs, hits_);
  context_.stages.hits += static_cast<long>(hits_.size());
}

/// Keeps the image for pictures: gaps at the pixels' centres, in double precision.
void ImageRegion::keep_view() {
  const auto pixels = static_cast<std::size_t>(camera().width) * static_cast<std::size_t>(camera().height);
  RegionView& region = context_.view->regions.emplace_back();
  region.axes = axes_.to_world;
  region.origin = axes_.origin;
  region.u0 = camera().u0;
  region.v0 = camera().v0;
  region.pixel = camera().pixel;
  region.width = camera().width;
  region.height = camera().height;
  region.gap.assign(pixels, std::nan(""));
  region.height_a.assign(pixels, std::nan(""));
  for (const FacePair& pair : request_.pairs) {
    const double u = camera().u(static_cast<int>(pair.at) % camera().width),
                 v = camera().v(static_cast<int>(pair.at) / camera().width);
    Vec3 weights;
    double a = 0.0, b = 0.0;
    if (!planes_a_.at(static_cast<int>(pair.a), u, v, weights, a) ||
        !planes_b_.at(static_cast<int>(pair.b), u, v, weights, b) || !(a - b < candidate_gap_))
      continue;
    region.gap[pair.at] = a - b;
    region.height_a[pair.at] = a;
  }
}

bool ImageRegion::presses() const {
  return std::any_of(hits_.begin(), hits_.end(), [](const Hit& hit) { return hit.at.gap() < 0.0; });
}

void ImageRegion::append_samples(std::vector<ContactSample>& samples,
                                 std::vector<CoupledNodes::Joint>* joints) {
  const ScopedTimer timer(context_.stages.gaps_s);
  const Vec3 normal = axes_.normal();
  for (const Hit& hit : hits_) {
    const auto on = [&](const ImageSide& side, const RegionMesh& mesh, int face, const Vec3& weights,
                        double w) {
      return side.carried(mesh.surface_faces()[static_cast<std::size_t>(face)], weights,
                          axes_.world(Vec3(hit.at.u, hit.at.v, w)), normal);
    };
    const CarriedPoint a = on(*context_.a, mesh_a_, hit.face_a, hit.at.weights_a, hit.at.w_a),
                       b = on(*context_.b, mesh_b_, hit.face_b, hit.at.weights_b, hit.at.w_b);
    ContactSample& sample = samples.emplace_back();
    sample.a = a.point;
    sample.b = b.point;
    sample.normal = normal;
    sample.area = hit.area;
    sample.gap = hit.at.gap();
    if (joints) joints->push_back(CoupledNodes::joint_of(a, b));
  }
}

}  // namespace palpate::contact
