#include <algorithm>
#include <numeric>
#include <utility>

#include "contact/image_source.h"
#include "palpate/core/clock.h"
#include "palpate/proxy/region.h"

namespace palpate::contact {
namespace {

/// Both surfaces whole.
class WholeRegion final : public ImageRegion {
 public:
  using ImageRegion::ImageRegion;

  void start(const proxy::Region& plane, double candidate_gap) {
    forget();
    candidate_gap_ = candidate_gap;
    axes_ = ContactAxes(plane.origin, plane.normal);
    {
      const ScopedTimer timer(context_.stages.patches_s);
      axes_.to_axes(context_.a->positions(), a_.uvw);
      axes_.to_axes(context_.b->positions(), b_.uvw);
      a_.faces = &context_.a->faces();
      b_.faces = &context_.b->faces();
      set_sources({context_.a.get(), all(faces_a_, a_)}, {context_.b.get(), all(faces_b_, b_)});
      window_ = fit_window(a_, b_, candidate_gap_);
    }
    finest_ = false;
    seen_ = ask(camera_of(window_, context_.first_pixels(), context_.shift()));
  }
  void take() override {
    see();
    if (!finest_) finest_ = ask_finer(window_);
  }
  void append_samples(SampleCells& samples) override {
    if (!seen_) return;
    finish();
    keep_view();
    const ScopedTimer timer(context_.stages.gaps_s);
    const auto same = [](int face) { return face; };
    append_hits(samples, same, same);
    presses_ =
        presses_ || std::any_of(hits_.begin(), hits_.end(), [](const Hit& h) { return h.at.gap() < 0.0; });
  }
  /// Whether something pressed at the last query that looked at it, once.
  bool take_presses() { return std::exchange(presses_, false); }
  bool presses() const { return presses_; }
  void set_presses(bool yes) { presses_ = yes; }

 private:
  static std::span<const int> all(std::vector<int>& faces, const Patch& patch) {
    if (faces.empty()) {
      faces.resize(static_cast<std::size_t>(patch.faces->cols()));
      std::iota(faces.begin(), faces.end(), 0);
    }
    return faces;
  }

  std::vector<int> faces_a_, faces_b_;
  ContactWindow window_;
  bool finest_ = false, seen_ = false, presses_ = false;
};

/// One region.
///
/// The finder's normal is the shortest way out of each other for the hulls.  Deeper than half of a body that
/// is out through its other side: followed, the contact would pull the bodies through each other.  So as long
/// as they have pressed each other since, the normal stays on the side that they came from.
class WholeSource final : public ImageSource {
 public:
  using ImageSource::ImageSource;

  long normals_kept() const override { return normals_kept_; }
  /// The side that the bodies came from is what the last query knew of it.
  void archive(Archive& a) override {
    ImageSource::archive(a);
    a("finder", finder_);
    a("normal", plane_.normal);
    a("thickness", thickness_);
    a("normals_kept", normals_kept_);
    bool there = one_ != nullptr, presses = there && one_->presses();
    a("was_near", there);
    a("presses", presses);
    if (a.gives_back() && there) {
      region(0);  // made, and with it `one_`
      one_->set_presses(presses);
    }
  }

 protected:
  std::size_t find_regions(const dynamics::StateView& state) override {
    const ScopedTimer timer(context_.stages.regions_s);
    ImageSide &a = *context_.a, &b = *context_.b;
    const double time = context_.options.look_ahead;
    const proxy::ProxyMotion of_a = time > 0.0 ? a.motion(state) : proxy::ProxyMotion{},
                             of_b = time > 0.0 ? b.motion(state) : proxy::ProxyMotion{};
    const proxy::Reach reach(context_.candidate_gap, time, of_a, of_b);
    const Vec3 last = plane_.normal;
    plane_ = finder_.find(a.positions(), b.positions(), reach.in_any_direction());
    const bool pressed = one_ && one_->take_presses();
    if (pressed && plane_.depth > 0.0 && plane_.normal.dot(last) < kSameSide) {
      plane_ = finder_.along(a.positions(), b.positions(), last, reach.in_any_direction());
      ++normals_kept_;
    }
    gap_ = reach.along(plane_.normal);
    context_.take_speed(std::max(0.0, -plane_.depth),
                        of_a.spread + of_b.spread - plane_.normal.dot(of_a.velocity - of_b.velocity),
                        thickness());
    return plane_.found && plane_.depth >= -gap_ ? 1 : 0;
  }
  double find_met(std::vector<int>& faces_a, std::vector<int>& faces_b) override {
    find_all_met(*context_.a, *context_.b, thickness(), faces_a, faces_b);
    return thickness();
  }
  std::unique_ptr<ImageRegion> make_region() override {
    auto region = std::make_unique<WholeRegion>(context_);
    one_ = region.get();
    return region;
  }
  void start(ImageRegion& region, std::size_t) override {
    static_cast<WholeRegion&>(region).start(plane_, gap_);
  }

 private:
  /// Of the thinner body, at the first query [m].
  double thickness() {
    if (thickness_ < 0.0)
      thickness_ =
          std::min(proxy::least_width(context_.a->positions()), proxy::least_width(context_.b->positions()));
    return thickness_;
  }

  static constexpr double kSameSide = 0.5;  // cosine
  proxy::RegionFinder finder_;
  proxy::Region plane_;
  WholeRegion* one_ = nullptr;  ///< null before something was near
  long normals_kept_ = 0;
  double gap_ = 0.0, thickness_ = -1.0;
};

}  // namespace

std::unique_ptr<SampleSource> make_whole_source(std::shared_ptr<ImageSide> a, std::shared_ptr<ImageSide> b,
                                                const ImageOptions& options) {
  return std::make_unique<WholeSource>(std::move(a), std::move(b), options);
}

}  // namespace palpate::contact
