#include <algorithm>
#include <span>

#include "contact/image_source.h"
#include "contact/self_contact_filter.h"
#include "palpate/core/clock.h"
#include "palpate/proxy/pruner.h"

namespace palpate::contact {
namespace {

/// The image of image_source.cpp, once for each region where proxies come near.
class PrunedSource final : public ImageSource {
 public:
  PrunedSource(std::shared_ptr<ImageSide> a, std::shared_ptr<proxy::ProxySet> proxies_a,
               std::shared_ptr<ImageSide> b, std::shared_ptr<proxy::ProxySet> proxies_b,
               const ImageOptions& options)
      : ImageSource(std::move(a), std::move(b), options),
        proxies_a_(std::move(proxies_a)),
        proxies_b_(std::move(proxies_b)),
        pruner_(*proxies_a_, *proxies_b_, {.between_bones = of_one_body()}) {}
  /// A body with itself: the skin of its bones.
  PrunedSource(std::shared_ptr<ImageSide> side, std::shared_ptr<proxy::ProxySet> proxies, Points rest_nodes,
               const ImageOptions& options)
      : PrunedSource(side, proxies, side, proxies, options) {
    self_contact_.emplace(*a_->soft(), std::move(rest_nodes));
    proxy_of_face_.resize(static_cast<std::size_t>(proxies_a_->face_count()));
    for (const proxy::SkinPatch& patch : proxies_a_->patches())
      for (const int face : proxies_a_->faces(patch))
        proxy_of_face_[static_cast<std::size_t>(face)] = patch.proxy;
  }

  const proxy::PruneCounts* pruning() const override { return &pruner_.counts(); }

 protected:
  void look(std::vector<ContactSample>& samples) override {
    for (const proxy::ContactRegion& region : regions()) {
      ContactAxes axes(region.region.origin, region.region.normal);
      take_pieces(region);
      ContactWindow window;
      ContactCamera camera;
      bool aligned = false;
      for (int i = 0; i < kAlignments && !aligned; ++i) {
        window = fit_pieces(axes);
        camera = camera_of(window, coarse_pixels(), shift());
        if (!see_pieces(camera, axes)) break;
        OverlapSlope slope;
        for (const Hit& hit : hits_)
          if (hit.at.gap() < 0.0) slope.add(slope_of(piece_a_, hit.face_a), slope_of(piece_b_, hit.face_b));
        aligned = !align_with_overlap(slope, axes);
      }
      if (!camera.sees_something()) continue;
      if (!aligned) window = fit_pieces(axes);
      if (!refine(window, axes, aligned, camera)) continue;
      finish(piece_a_.patch, piece_b_.patch, camera);
      leave_own_tissue(axes);  // what finish() has found besides
      const ScopedTimer timer(stages_.gaps_s);
      for (const Hit& hit : hits_)
        samples.push_back(sample_of(hit.at, hit.area, *a_,
                                    piece_a_.face_of[static_cast<std::size_t>(hit.face_a)], *b_,
                                    piece_b_.face_of[static_cast<std::size_t>(hit.face_b)], axes));
    }
  }

 private:
  std::span<const proxy::ContactRegion> regions() {
    const ScopedTimer timer(stages_.regions_s);
    a_->update(*proxies_a_);
    if (!of_one_body()) b_->update(*proxies_b_);
    return pruner_.query(candidate_gap_);
  }

  /// The faces of a region with vertices of their own.
  struct Piece {
    Faces faces;
    std::vector<int> face_of;  ///< in the whole surface
    Patch patch;

    void take(const ImageSide& whole, const std::vector<int>& wanted) {
      const Faces& all = whole.faces();
      for (const int vertex : taken_) local_[static_cast<std::size_t>(vertex)] = -1;
      taken_.clear();
      if (local_.empty()) local_.assign(static_cast<std::size_t>(all.maxCoeff()) + 1, -1);
      wanted_ = wanted;
      corners_.resize(3, static_cast<Eigen::Index>(wanted.size()));
      for (std::size_t i = 0; i < wanted.size(); ++i)
        for (int k = 0; k < 3; ++k) {
          const int vertex = all(k, wanted[i]);
          int& at = local_[static_cast<std::size_t>(vertex)];
          if (at < 0) {
            at = static_cast<int>(taken_.size());
            taken_.push_back(vertex);
          }
          corners_(k, static_cast<Eigen::Index>(i)) = at;
        }
      world_.resize(3, static_cast<Eigen::Index>(taken_.size()));
      for (std::size_t i = 0; i < taken_.size(); ++i)
        world_.col(static_cast<Eigen::Index>(i)) = whole.vertex(taken_[i]);
    }
    /// Along these axes, those whose normal has the sign `side` along the plane's: what faces away lies
    /// behind skin of its own body, which may be in another region.
    void see(const ContactAxes& axes, double side) {
      axes.to_axes(world_, patch.uvw);
      face_of.clear();
      faces.resize(3, corners_.cols());
      for (Eigen::Index i = 0; i < corners_.cols(); ++i) {
        const auto at = [&](int k) { return patch.uvw.col(corners_(k, i)).head<2>(); };
        const Eigen::Vector2d e = at(1) - at(0), f = at(2) - at(0);
        if (side * (e.x() * f.y() - e.y() * f.x()) <= 0.0) continue;
        faces.col(static_cast<Eigen::Index>(face_of.size())) = corners_.col(i);
        face_of.push_back(wanted_[static_cast<std::size_t>(i)]);
      }
      faces.conservativeResize(3, static_cast<Eigen::Index>(face_of.size()));
      patch.faces = &faces;
    }

   private:
    std::vector<int> wanted_;
    Faces corners_;
    std::vector<int> local_;  ///< of the surface's vertices, -1: not taken
    std::vector<int> taken_;
    Points world_;  ///< where these are
  };

  void take_pieces(const proxy::ContactRegion& region) {
    const ScopedTimer timer(stages_.patches_s);
    piece_a_.take(*a_, region.faces_a);
    piece_b_.take(*b_, region.faces_b);
  }

  ContactWindow fit_pieces(const ContactAxes& axes) {
    const ScopedTimer timer(stages_.patches_s);
    piece_a_.see(axes, -1.0);
    piece_b_.see(axes, 1.0);
    if (piece_a_.faces.cols() == 0 || piece_b_.faces.cols() == 0) return {};
    return fit_window(piece_a_.patch, piece_b_.patch, candidate_gap_);
  }

  /// False where there is nothing to see; the faces of `hits_` are those of the pieces.
  bool see_pieces(const ContactCamera& camera, const ContactAxes& axes) {
    hits_.clear();
    if (!camera.sees_something()) return false;
    see(piece_a_.patch, piece_b_.patch, camera);
    leave_own_tissue(axes);
    return true;
  }

  void leave_own_tissue(const ContactAxes& axes) {
    if (self_contact_)
      std::erase_if(hits_, [&](const Hit& h) { return !may_touch(h.at, h.face_a, h.face_b, axes); });
  }

  /// The image that counts.  @param seen  there is one along these axes, by `camera`
  bool refine(const ContactWindow& window, const ContactAxes& axes, bool seen, ContactCamera& camera) {
    if (!seen || !(options_.quadrature_error > 0.0)) {
      camera = camera_of(window, first_pixels(), shift());
      if (!see_pieces(camera, axes)) return false;
    }
    if (ContactCamera finer; needs_finer(piece_a_.patch, piece_b_.patch, window, camera, finer))
      see_pieces(camera = finer, axes);
    return true;
  }

  /// For contact of a body with itself: a pair of proxies, each of which is looked at once, and not the far
  /// side of its own tissue.
  bool may_touch(const Facing& at, int face_a, int face_b, const ContactAxes& axes) const {
    const int a = piece_a_.face_of[static_cast<std::size_t>(face_a)],
              b = piece_b_.face_of[static_cast<std::size_t>(face_b)];
    if (!pruner_.is_pair(proxy_of_face_[static_cast<std::size_t>(a)],
                         proxy_of_face_[static_cast<std::size_t>(b)]))
      return false;
    return at.gap() >= 0.0 ||
           self_contact_->in_contact(
               self_contact_->point(a, at.weights_a, axes.world(Vec3(at.u, at.v, at.w_a))),
               self_contact_->point(b, at.weights_b, axes.world(Vec3(at.u, at.v, at.w_b))));
  }

  // The region's normal came from patches, which reach beyond the overlap, more or less as the body is cut.
  // The overlap itself has one: its boundary is closed, so the area vectors of a's skin in b and of b's in a
  // are opposite, and their common direction pushes the bodies apart.  Seen along n, a pixel of area dA shows
  // (s, 1) dA of each, s the slope of -a's or of b's skin: n is tilted by the mean slope of both, and kept
  // where that is zero.  It depends on the pose alone.
  // A mean over the overlap needs few pixels: those of a first image, or a quarter of the image's edge.
  static constexpr int kAlignments = 3;
  int coarse_pixels() const { return std::min(first_pixels(), std::max(64, options_.pixels / 4)); }

  struct OverlapSlope {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    long pressed = 0;
    void add(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      sum += 0.5 * (a + b);
      ++pressed;
    }
  };
  static Eigen::Vector2d slope_of(const Piece& piece, int face) {
    constexpr double kSteepest = 10.0;  // a wall's slope is no direction
    const auto at = [&](int k) { return piece.patch.uvw.col(piece.faces(k, face)); };
    const Vec3 area = Vec3(at(1) - at(0)).cross(Vec3(at(2) - at(0)));
    const Eigen::Vector2d s = area.head<2>() / area.z();
    return s * std::min(1.0, kSteepest / std::max(s.norm(), 1e-300));
  }
  /// False where the axes are aligned already, or nothing overlaps.
  static bool align_with_overlap(const OverlapSlope& slope, ContactAxes& axes) {
    constexpr double kAligned = 1e-3;  // [rad]
    if (slope.pressed == 0) return false;
    const Eigen::Vector2d mean = slope.sum / static_cast<double>(slope.pressed);
    if (!(mean.norm() > kAligned)) return false;
    axes = ContactAxes(axes.origin, (axes.to_world * Vec3(mean.x(), mean.y(), 1.0)).normalized());
    return true;
  }

  std::shared_ptr<proxy::ProxySet> proxies_a_, proxies_b_;
  proxy::Pruner pruner_;
  Piece piece_a_, piece_b_;
  std::optional<SelfContactFilter> self_contact_;  ///< of a body with itself, else empty
  std::vector<int> proxy_of_face_;
};

}  // namespace

std::unique_ptr<SampleSource> make_pruned_source(std::shared_ptr<ImageSide> a,
                                                 std::shared_ptr<proxy::ProxySet> proxies_a,
                                                 std::shared_ptr<ImageSide> b,
                                                 std::shared_ptr<proxy::ProxySet> proxies_b,
                                                 const ImageOptions& options) {
  return std::make_unique<PrunedSource>(std::move(a), std::move(proxies_a), std::move(b),
                                        std::move(proxies_b), options);
}

std::unique_ptr<SampleSource> make_pruned_source(std::shared_ptr<ImageSide> side,
                                                 std::shared_ptr<proxy::ProxySet> proxies, Points rest_nodes,
                                                 const ImageOptions& options) {
  return std::make_unique<PrunedSource>(std::move(side), std::move(proxies), std::move(rest_nodes), options);
}

}  // namespace palpate::contact
