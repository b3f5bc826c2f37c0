#include <algorithm>
#include <numeric>
#include <utility>

#include "contact/image_source.h"
#include "proxy/least_width.h"
#include "proxy/reach.h"
#include "proxy/region.h"

namespace palpate::contact {
namespace {

std::vector<int> all_faces(const ImageSide& side) {
  std::vector<int> out(static_cast<std::size_t>(side.faces().cols()));
  std::iota(out.begin(), out.end(), 0);
  return out;
}

/// Image-space contact with one region.
///
/// The region finder's normal is the shortest direction out of each other for the hulls. If the overlap is
/// deeper than half of a body, that direction leads out through its other side, and contact would pull the
/// bodies through each other. Therefore, as long as the bodies have been pressing continuously, the normal
/// stays on the side that they came from.
class WholeSource final : public ImageSource {
 public:
  WholeSource(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b, const ImageOptions& options)
      : ImageSource(std::move(a), std::move(b), options),
        faces_a_(all_faces(*context_.a)),
        faces_b_(all_faces(*context_.b)) {}

  SourceReport report() const override {
    SourceReport out = ImageSource::report();
    out.normals_kept = normals_kept_;
    return out;
  }
  /// Saves or restores also the side that the bodies came from, known from the last query.
  void archive(Archive& a) override {
    ImageSource::archive(a);
    a("finder", finder_);
    a("normal", normal_);
    a("thickness", thickness_);
    a("normals_kept", normals_kept_);
    a("presses", presses_);
  }

 protected:
  void find_regions(const dynamics::StateView& state, std::vector<RegionPlane>& out) override {
    ImageSide &a = *context_.a, &b = *context_.b;
    const double time = context_.options.look_ahead;
    const proxy::ProxyMotion of_a = time > 0.0 ? a.motion(state) : proxy::ProxyMotion{},
                             of_b = time > 0.0 ? b.motion(state) : proxy::ProxyMotion{};
    const proxy::Reach reach(context_.options.candidate_gap, time, of_a, of_b);
    proxy::Region plane = finder_.find(a.positions(), b.positions(), reach.in_any_direction());
    if (std::exchange(presses_, false) && plane.depth > 0.0 && plane.normal.dot(normal_) < kSameSide) {
      plane = finder_.along(a.positions(), b.positions(), normal_, reach.in_any_direction());
      ++normals_kept_;
    }
    normal_ = plane.normal;
    const double gap = reach.along(plane.normal);
    context_.take_speed(std::max(0.0, -plane.depth),
                        of_a.spread + of_b.spread - plane.normal.dot(of_a.velocity - of_b.velocity),
                        thickness());
    if (plane.found && plane.depth >= -gap)
      out.push_back({plane.origin, plane.normal, gap, &faces_a_, &faces_b_});
  }
  double collect_candidate_faces(std::vector<int>& faces_a, std::vector<int>& faces_b) override {
    find_all_met(*context_.a, *context_.b, thickness(), faces_a, faces_b);
    return thickness();
  }
  void take_pressing(std::size_t) override { presses_ = true; }

 private:
  /// Returns the thickness of the thinner body at the first query [m].
  double thickness() {
    if (thickness_ < 0.0)
      thickness_ =
          std::min(proxy::least_width(context_.a->positions()), proxy::least_width(context_.b->positions()));
    return thickness_;
  }

  static constexpr double kSameSide = 0.5;  // Cosine.
  std::vector<int> faces_a_, faces_b_;
  proxy::RegionFinder finder_;
  Vec3 normal_ = Vec3::UnitZ();  ///< Normal of the last query.
  bool presses_ = false;         ///< True: the region has pressed since then.
  long normals_kept_ = 0;
  double thickness_ = -1.0;
};

}  // namespace

std::unique_ptr<SampleSource> make_whole_source(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b,
                                                const ImageOptions& options) {
  return std::make_unique<WholeSource>(std::move(a), std::move(b), options);
}

}  // namespace palpate::contact
