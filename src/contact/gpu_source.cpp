#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "contact/gpu_image.h"
#include "contact/surface_state.h"
#include "palpate/contact/sources.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/proxy/pruner.h"
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

/// Two triangles at a pixel.
struct Facing {
  double u, v, w_a, w_b;  ///< [m]
  Vec3 weights_a;         ///< of a's corners
  double gap() const { return w_a - w_b; }
};

/// The image said which triangles; the gap is theirs at the pixel's own (u, v), in double.
std::optional<Facing> facing_at(const PixelPair& pair, const ContactCamera& camera, const Patch& a, int face_a, const Patch& b, int face_b) {
  Facing at;
  at.u = camera.u(static_cast<int>(pair.pixel) % camera.width);
  at.v = camera.v(static_cast<int>(pair.pixel) / camera.width);
  Vec3 weights_b;
  if (!barycentric(a, face_a, at.u, at.v, at.weights_a) || !barycentric(b, face_b, at.u, at.v, weights_b)) {
    counters::count("contact.gpu_edge_on");
    return std::nullopt;
  }
  at.w_a = height(a, face_a, at.weights_a);
  at.w_b = height(b, face_b, weights_b);
  return at;
}

ContactSample sample_of(const Facing& at, const SurfaceState& surface, int face, const ContactCamera& camera, const ContactAxes& axes, int frame, const Pose& inverse) {
  ContactSample sample;
  sample.a = surface.face_point(face, at.weights_a);
  sample.b = frame_point(frame, inverse, axes.world(Vec3(at.u, at.v, at.w_b)));
  sample.normal = axes.normal();
  sample.area = camera.pixel * camera.pixel;
  sample.gap = at.gap();
  return sample;
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
    const Pose inverse = pose.inverse();
    for (const PixelPair& pair : pairs_) {
      const int face_a = a_.visible[pair.a], face_b = b_.visible[pair.b];
      const std::optional<Facing> facing = facing_at(pair, camera, a_, face_a, b_, face_b);
      if (facing && facing->gap() < options_.candidate_gap) samples.push_back(sample_of(*facing, surface_, face_a, camera, axes, frame_, inverse));
    }
  }

 private:
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

/// The same image, once for each region that the proxies leave.
class PrunedGpuSource final : public SampleSource {
 public:
  PrunedGpuSource(NodeSurface surface, std::shared_ptr<proxy::ProxySet> proxies, TriMesh rigid, int frame, std::shared_ptr<MovingFrame> motion, const GpuOptions& options)
      : surface_(std::move(surface)), proxies_(std::move(proxies)), rigid_(std::move(rigid)), rigid_proxies_(in_one_hull(rigid_)), pruner_(*proxies_, rigid_proxies_), frame_(frame),
        motion_(std::move(motion)), options_(options) {
    PALPATE_CHECK(motion_, "a gpu source needs a frame");
    PALPATE_CHECK(proxies_->face_count() == surface_.face_count(), "proxies of {} faces for a surface of {}", proxies_->face_count(), surface_.face_count());
    counters::count("contact.gpu_source");
  }

  std::string_view name() const override { return "gpu"; }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { surface_.add_face_pattern(pattern); }
  std::uint64_t pattern_version() const override { return surface_.pattern_version(); }
  const proxy::PruneCounts* pruning() const override { return &pruner_.counts(); }

  // a is the soft surface, b the rigid one.
  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    surface_.update(state);
    if (options_.candidate_gap == 0.0) options_.candidate_gap = 0.25 * surface_.mean_edge();
    const Pose pose = motion_->pose(state), inverse = pose.inverse();
    proxies_->update(surface_.nodes());
    rigid_proxies_.update(pose);
    for (const proxy::ContactRegion& region : pruner_.query(options_.candidate_gap)) {
      ContactAxes axes(region.region.origin, region.region.normal);
      ContactCamera camera = look(region, axes, pose);
      for (int turn = 0; turn < kTurns && turn_to_overlap(axes); ++turn) camera = look(region, axes, pose);
      for (const FacingFaces& at : facings_) samples.push_back(sample_of(at.facing, surface_, a_.face_of[static_cast<std::size_t>(at.face_a)], camera, axes, frame_, inverse));
    }
  }

 private:
  /// The faces of a region with vertices of their own.
  struct Piece {
    Faces faces;
    std::vector<int> face_of;  ///< in the whole surface
    Patch patch;
    std::vector<int> local;    ///< of the surface's vertices, -1: not taken
    std::vector<int> taken;

    /// Those whose normal has the sign `side` along the plane's: what is turned away lies behind skin of its own body, which may be in another region.
    template <class Place>
    void take(const Faces& all, const std::vector<int>& wanted, double side, const Place& place) {
      for (const int vertex : taken) local[static_cast<std::size_t>(vertex)] = -1;
      taken.clear();
      if (local.empty()) local.assign(static_cast<std::size_t>(all.maxCoeff()) + 1, -1);
      for (const int face : wanted)
        for (const int vertex : all.col(face))
          if (int& at = local[static_cast<std::size_t>(vertex)]; at < 0) {
            at = static_cast<int>(taken.size());
            taken.push_back(vertex);
          }
      patch.uvw.resize(3, static_cast<Eigen::Index>(taken.size()));
      for (std::size_t i = 0; i < taken.size(); ++i) patch.uvw.col(static_cast<Eigen::Index>(i)) = place(taken[i]);
      face_of.clear();
      faces.resize(3, static_cast<Eigen::Index>(wanted.size()));
      for (const int face : wanted) {
        Eigen::Vector3i corner;
        for (int k = 0; k < 3; ++k) corner[k] = local[static_cast<std::size_t>(all(k, face))];
        const auto at = [&](int k) { return patch.uvw.col(corner[k]).head<2>(); };
        const Eigen::Vector2d e = at(1) - at(0), f = at(2) - at(0);
        if (side * (e.x() * f.y() - e.y() * f.x()) <= 0.0) continue;
        faces.col(static_cast<Eigen::Index>(face_of.size())) = corner;
        face_of.push_back(face);
      }
      faces.conservativeResize(3, static_cast<Eigen::Index>(face_of.size()));
      patch.faces = &faces;
    }
  };

  struct FacingFaces {
    Facing facing;
    int face_a, face_b;  ///< of the pieces
  };

  /// Fills `facings_` with what the region shows along these axes.
  ContactCamera look(const proxy::ContactRegion& region, const ContactAxes& axes, const Pose& pose) {
    facings_.clear();
    const Mat3 turn = pose.rotation.toRotationMatrix();
    a_.take(surface_.faces(), region.faces_a, -1.0, [&](int vertex) { return axes.in_axes(surface_.positions().col(vertex)); });
    b_.take(rigid_.faces, region.faces_b, 1.0, [&](int vertex) { return axes.in_axes(turn * rigid_.vertices.col(vertex) + pose.translation); });
    if (a_.faces.cols() == 0 || b_.faces.cols() == 0) return {};
    const ContactCamera camera = fit_camera(a_.patch, b_.patch, options_.candidate_gap, options_.pixels, {options_.shift_u, options_.shift_v});
    if (!camera.sees_something()) return camera;
    if (!image_) image_.emplace(options_.pixels);
    image_->find_pairs(a_.patch, b_.patch, camera, options_.candidate_gap, pairs_);
    for (const PixelPair& pair : pairs_) {
      const int face_a = a_.patch.visible[pair.a], face_b = b_.patch.visible[pair.b];
      const std::optional<Facing> facing = facing_at(pair, camera, a_.patch, face_a, b_.patch, face_b);
      if (facing && facing->gap() < options_.candidate_gap) facings_.push_back({*facing, face_a, face_b});
    }
    return camera;
  }

  // The region's normal came from patches, which reach beyond the overlap, more or less as the body is cut.  The overlap itself has one: its boundary is closed, so the
  // area vectors of a's skin in b and of b's in a are opposite, and their common direction pushes the bodies apart.  Seen along n, a pixel of area dA shows (s, 1) dA of
  // each, s the slope of -a's or of b's skin: n turns by the mean slope of both, and stays where that is zero.  It depends on the pose alone.
  static constexpr int kTurns = 3;
  bool turn_to_overlap(ContactAxes& axes) const {
    constexpr double kAligned = 1e-3, kSteepest = 10.0;  // [rad]; a wall's slope is no direction
    const auto slope = [&](const Piece& piece, int face) -> Eigen::Vector2d {
      const auto at = [&](int k) { return piece.patch.uvw.col(piece.faces(k, face)); };
      const Vec3 area = Vec3(at(1) - at(0)).cross(Vec3(at(2) - at(0)));
      const Eigen::Vector2d s = area.head<2>() / area.z();
      return s * std::min(1.0, kSteepest / std::max(s.norm(), 1e-300));
    };
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    long pressed = 0;
    for (const FacingFaces& at : facings_)
      if (at.facing.gap() < 0.0) {
        sum += 0.5 * (slope(a_, at.face_a) + slope(b_, at.face_b));
        ++pressed;
      }
    if (pressed == 0) return false;
    const Eigen::Vector2d mean = sum / static_cast<double>(pressed);
    if (!(mean.norm() > kAligned)) return false;
    axes = ContactAxes(axes.origin, (axes.to_world * Vec3(mean.x(), mean.y(), 1.0)).normalized());
    return true;
  }

  /// A rigid surface as one proxy: the hull of its farthest points in 32 directions (on a Fibonacci spiral), which the set grows until it holds them all.
  static proxy::ProxySet in_one_hull(const TriMesh& rigid) {
    LayeredModel model;
    model.name = "rigid surface";
    model.skin = rigid;
    ProxyHull hull;
    std::vector<int> corners;
    constexpr int kDirections = 32;
    for (int i = 0; i < kDirections; ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / kDirections, turn = i * M_PI * (3.0 - std::sqrt(5.0)), r = std::sqrt(1.0 - z * z);
      Eigen::Index farthest = 0;
      (Vec3(r * std::cos(turn), r * std::sin(turn), z).transpose() * rigid.vertices).maxCoeff(&farthest);
      corners.push_back(static_cast<int>(farthest));
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    hull.corners = rigid.vertices(Eigen::all, corners);
    hull.members.resize(static_cast<std::size_t>(rigid.vertices.cols()));
    std::iota(hull.members.begin(), hull.members.end(), 0);
    model.proxies.push_back(std::move(hull));
    return proxy::ProxySet(model, {.patch_faces = 16});  // few faces in all: a finer grain costs more than it spares
  }

  SurfaceState surface_;
  std::shared_ptr<proxy::ProxySet> proxies_;
  TriMesh rigid_;
  proxy::ProxySet rigid_proxies_;
  proxy::Pruner pruner_;
  int frame_;
  std::shared_ptr<MovingFrame> motion_;
  GpuOptions options_;
  std::optional<GpuImage> image_;
  Piece a_, b_;
  std::vector<PixelPair> pairs_;
  std::vector<FacingFaces> facings_;
};

void check_arguments(const NodeSurface& surface, const TriMesh& rigid, const GpuOptions& options) {
  if (options.pixels < 2 || options.pixels > 8192) fail("gpu contact: pixels = {} must lie between 2 and 8192", options.pixels);
  if (!(options.candidate_gap >= 0.0)) fail("gpu contact: candidate gap = {} must not be negative", options.candidate_gap);
  for (const double shift : {options.shift_u, options.shift_v})
    if (!(shift >= 0.0 && shift < 1.0)) fail("gpu contact: grid shift = {} must lie in [0, 1)", shift);
  if (surface.faces.cols() == 0 || rigid.faces.cols() == 0) fail("gpu contact needs two surfaces with faces, got {} and {}", surface.faces.cols(), rigid.faces.cols());
  for (Eigen::Index f = 0; f < rigid.faces.cols(); ++f)
    PALPATE_CHECK(rigid.faces.col(f).minCoeff() >= 0 && rigid.faces.col(f).maxCoeff() < rigid.vertices.cols(), "rigid surface: face {} names a vertex that is not there", f);
}

}  // namespace

std::unique_ptr<SampleSource> make_gpu_source(NodeSurface surface, TriMesh rigid, int frame, std::shared_ptr<MovingFrame> motion,
                                              const GpuOptions& options) {
  check_arguments(surface, rigid, options);
  return std::make_unique<GpuSource>(std::move(surface), std::move(rigid), frame, std::move(motion), options);
}

std::unique_ptr<SampleSource> make_gpu_source(NodeSurface surface, std::shared_ptr<proxy::ProxySet> proxies, TriMesh rigid, int frame, std::shared_ptr<MovingFrame> motion,
                                              const GpuOptions& options) {
  check_arguments(surface, rigid, options);
  PALPATE_CHECK(proxies && surface.node_of_vertex.empty(), "a pruned gpu source needs a skin and its proxies");
  return std::make_unique<PrunedGpuSource>(std::move(surface), std::move(proxies), std::move(rigid), frame, std::move(motion), options);
}

}  // namespace palpate::contact
