#include "images.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/gpu_device.h"
#include "palpate/core/error.h"

namespace palpate::validation {
namespace {

/// Returns an empty string if images work; otherwise the missing part.
const std::string& image_error() {
  static const std::string error = [] {
    try {
      contact::open_gpu();
      return std::string();
    } catch (const Error& e) { return std::string(e.what()); }
  }();
  return error;
}

class SpoiledSource final : public contact::SampleSource {
 public:
  SpoiledSource(std::unique_ptr<contact::SampleSource> source, Spoil seed_defect)
      : SampleSource({.name = source->traits().name}),
        source_(std::move(source)),
        spoil_(std::move(seed_defect)) {}
  void add_pattern(dynamics::PatternBuilder& pattern) const override { source_->add_pattern(pattern); }
  std::uint64_t pattern_version() const override { return source_->pattern_version(); }
  void query(const dynamics::StateView& state, std::vector<contact::ContactSample>& samples) override {
    std::vector<contact::ContactSample> own;
    source_->query(state, own);
    spoil_(own);
    samples.insert(samples.end(), own.begin(), own.end());
  }

 private:
  std::unique_ptr<contact::SampleSource> source_;
  Spoil spoil_;
};

}  // namespace

bool images_work() { return image_error().empty(); }

void say_what_is_skipped(std::vector<Measurement>& out) {
  if (images_work()) return;
  Measurement m;
  m.quantity = "image: SKIPPED, not measured: " + image_error();
  m.computed = m.exact = std::nan("");
  m.bar = std::numeric_limits<double>::infinity();
  out.push_back(m);
}

std::vector<contact::ContactSample> pixels_of(contact::SampleSource& source,
                                              const dynamics::StateView& state) {
  source.keep_view();
  std::vector<contact::ContactSample> samples;
  source.query(state, samples);
  samples.clear();
  for (const contact::RegionView& region : source.report().view->regions)
    for (int row = 0; row < region.height; ++row)
      for (int column = 0; column < region.width; ++column) {
        const auto at = static_cast<std::size_t>(row * region.width + column);
        if (std::isnan(region.gap[at])) continue;
        const auto world = [&](double w) -> Vec3 {
          return region.origin + region.axes * Vec3(region.u0 + (column + 0.5) * region.pixel,
                                                    region.v0 + (row + 0.5) * region.pixel, w);
        };
        contact::ContactSample& sample = samples.emplace_back();
        sample.a.frame = sample.b.frame = 0;
        sample.a.offset = world(region.height_a[at]);
        sample.b.offset = world(region.height_a[at] - region.gap[at]);
        sample.normal = region.axes.col(2);
        sample.area = region.pixel * region.pixel;
        sample.gap = region.gap[at];
      }
  return samples;
}

double overlap_volume(const std::vector<contact::ContactSample>& samples) {
  double sum = 0.0;
  for (const contact::ContactSample& s : samples) sum += std::max(0.0, -s.gap) * s.area;
  return sum;
}

std::unique_ptr<contact::SampleSource> held(std::unique_ptr<contact::SampleSource> source) {
  return spoiled(std::move(source), [](auto&) {});
}

std::unique_ptr<contact::SampleSource> spoiled(std::unique_ptr<contact::SampleSource> source,
                                               Spoil seed_defect) {
  return std::make_unique<SpoiledSource>(std::move(source), std::move(seed_defect));
}

GridShift grid_shift(int i) {
  return {std::fmod(0.754877666 * (i + 1), 1.0), std::fmod(0.569840291 * (i + 1), 1.0)};
}

Measurement over_pixels(Measurement requested, const std::vector<int>& pixels,
                        const std::function<double(int, const GridShift&)>& sampled) {
  std::vector<double> h, error;
  for (const int count : pixels) {
    double squares = 0.0;
    for (int i = 0; i < kGridShifts; ++i) {
      requested.computed = sampled(count, grid_shift(i));
      squares += std::pow(requested.computed / requested.exact - 1.0, 2) / kGridShifts;
    }
    h.push_back(1.0 / count);
    error.push_back(std::sqrt(squares));
  }
  requested.error = error.back();
  requested.order = fitted_order(h, error);
  requested.note = fmt::format("order in pixel size over {} to {}", pixels.front(), pixels.back());
  requested.refinement = {"pixel / edge of the image", h, error};
  return requested;
}

}  // namespace palpate::validation
