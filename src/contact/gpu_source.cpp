#include <cmath>
#include <optional>

#include "contact/gpu_image.h"
#include "contact/surface_state.h"
#include "palpate/contact/sources.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/proxy/region.h"

namespace palpate::contact {
namespace {

/// Barycentric coordinates of (u, v) in the projected triangle: false when it is seen edge-on, or (u, v) lies outside by more than
/// the rasteriser's sub-pixel grid explains (a quarter of the triangle), where the plane would be extrapolated too far.
bool barycentric(const Patch& patch, int face, double u, double v, Vec3& weights) {
  constexpr double kOutside = -0.25, kFlat = 1e-12;
  const auto corner = [&](int k) { return patch.uvw.col((*patch.faces)(k, face)); };
  const double ax = corner(0).x() - u, ay = corner(0).y() - v, bx = corner(1).x() - u, by = corner(1).y() - v, cx = corner(2).x() - u,
               cy = corner(2).y() - v;
  const Vec3 twice_areas(bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx);
  const double sum = twice_areas.sum();
  const double size = (corner(1) - corner(0)).squaredNorm() + (corner(2) - corner(0)).squaredNorm();
  if (std::abs(sum) <= kFlat * size) return false;
  weights = twice_areas / sum;
  return weights.minCoeff() >= kOutside;
}

double height(const Patch& patch, int face, const Vec3& weights) {
  double w = 0.0;
  for (int k = 0; k < 3; ++k) w += weights[k] * patch.uvw(2, (*patch.faces)(k, face));
  return w;
}

class GpuSource final : public SampleSource {
 public:
  GpuSource(NodeSurface surface, TriMesh rigid, int frame, std::shared_ptr<MovingFrame> motion, const GpuOptions& options)
      : surface_(std::move(surface)), rigid_(std::move(rigid)), frame_(frame), motion_(std::move(motion)), options_(options) {
    PALPATE_CHECK(motion_, "a gpu source needs a frame");
    counters::count("contact.gpu_source");
  }

  std::string_view name() const override { return "gpu"; }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { surface_.add_face_pattern(pattern); }
  std::uint64_t pattern_version() const override { return surface_.pattern_version(); }

  // a is the soft surface, b the rigid one; the normal points from b to a.
  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    surface_.update(state);
    if (options_.candidate_gap == 0.0) options_.candidate_gap = 0.25 * surface_.mean_edge();
    const Pose pose = motion_->pose(state);
    rigid_world_.noalias() = pose.rotation.toRotationMatrix() * rigid_.vertices;
    rigid_world_.colwise() += pose.translation;
    const proxy::Region region = regions_.find(surface_.positions(), rigid_world_, options_.candidate_gap);
    if (!region.found) return;
    const ContactAxes axes(region.origin, region.normal);
    axes.to_axes(surface_.positions(), a_.uvw);
    axes.to_axes(rigid_world_, b_.uvw);
    a_.faces = &surface_.faces();
    b_.faces = &rigid_.faces;
    const ContactCamera camera = fit_camera(a_, b_, options_.candidate_gap, options_.pixels, {options_.shift_u, options_.shift_v});
    if (!camera.sees_something()) return;
    if (!image_) image_.emplace(options_.pixels);
    image_->find_pairs(a_, b_, camera, options_.candidate_gap, pairs_);
    for (const PixelPair& pair : pairs_) add_sample(pair, camera, axes, pose.inverse(), samples);
  }

 private:
  /// The image said which triangles; the gap is theirs at the pixel's own (u, v), in double.
  void add_sample(const PixelPair& pair, const ContactCamera& camera, const ContactAxes& axes, const Pose& inverse, std::vector<ContactSample>& samples) {
    const int face_a = a_.visible[pair.a], face_b = b_.visible[pair.b];
    const double u = camera.u(static_cast<int>(pair.pixel) % camera.width), v = camera.v(static_cast<int>(pair.pixel) / camera.width);
    Vec3 weights_a, weights_b;
    if (!barycentric(a_, face_a, u, v, weights_a) || !barycentric(b_, face_b, u, v, weights_b)) return counters::count("contact.gpu_edge_on");
    const double w_a = height(a_, face_a, weights_a), w_b = height(b_, face_b, weights_b);
    if (w_a - w_b >= options_.candidate_gap) return;
    ContactSample sample;
    sample.a = surface_.face_point(face_a, weights_a);
    sample.b = frame_point(frame_, inverse, axes.world(Vec3(u, v, w_b)));
    sample.normal = axes.normal();
    sample.area = camera.pixel * camera.pixel;
    sample.gap = w_a - w_b;
    samples.push_back(sample);
  }

  SurfaceState surface_;
  TriMesh rigid_;
  int frame_;
  std::shared_ptr<MovingFrame> motion_;
  GpuOptions options_;
  proxy::RegionFinder regions_;
  std::optional<GpuImage> image_;  // opened at the first query that sees something
  Patch a_, b_;
  Points rigid_world_;
  std::vector<PixelPair> pairs_;
};

}  // namespace

std::unique_ptr<SampleSource> make_gpu_source(NodeSurface surface, TriMesh rigid, int frame, std::shared_ptr<MovingFrame> motion,
                                              const GpuOptions& options) {
  if (options.pixels < 2 || options.pixels > 8192) fail("gpu contact: pixels = {} must lie between 2 and 8192", options.pixels);
  if (!(options.candidate_gap >= 0.0)) fail("gpu contact: candidate gap = {} must not be negative", options.candidate_gap);
  for (const double shift : {options.shift_u, options.shift_v})
    if (!(shift >= 0.0 && shift < 1.0)) fail("gpu contact: grid shift = {} must lie in [0, 1)", shift);
  if (surface.faces.cols() == 0 || rigid.faces.cols() == 0) fail("gpu contact needs two surfaces with faces, got {} and {}", surface.faces.cols(), rigid.faces.cols());
  for (Eigen::Index f = 0; f < rigid.faces.cols(); ++f)
    PALPATE_CHECK(rigid.faces.col(f).minCoeff() >= 0 && rigid.faces.col(f).maxCoeff() < rigid.vertices.cols(), "rigid surface: face {} names a vertex that is not there", f);
  return std::make_unique<GpuSource>(std::move(surface), std::move(rigid), frame, std::move(motion), options);
}

}  // namespace palpate::contact
