#include "image_backends.h"

#include <cmath>

#include "b_bodies.h"
#include "palpate/contact/gpu_available.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

namespace palpate::validation {
namespace {

/// Empty where images on the GPU work; else what is missing.
std::string gpu_error() {
  if (!contact::gpu_available()) return "this build has no GPU images (PALPATE_WITH_GL)";
  TriMesh lower = mesh::box_surface(Vec3::Ones(), {1, 1, 1}), upper = lower;
  upper.vertices.row(2).array() += 0.9;
  SurfaceBody body(upper);
  contact::ImageOptions options;
  options.backend = contact::DepthBackend::kGpu;
  options.pixels = 16;
  options.candidate_gap = 1e-3;
  std::vector<contact::ContactSample> samples;
  try {
    contact::make_image_source(body.surface, lower, 0, contact::fixed_frame(), options)
        ->query(body.state.view(), samples);
  } catch (const Error& error) { return error.what(); }
  return {};
}

const std::string& known_gpu_error() {
  static const std::string error = gpu_error();
  return error;
}

class SpoiledSource final : public contact::SampleSource {
 public:
  SpoiledSource(std::unique_ptr<contact::SampleSource> source, Spoil spoil)
      : source_(std::move(source)), spoil_(std::move(spoil)) {}
  std::string_view name() const override { return source_->name(); }
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

std::vector<contact::DepthBackend> image_backends(const std::string& fault) {
  if (!fault.empty()) return {contact::DepthBackend::kCpu};
  std::vector<contact::DepthBackend> out = {contact::DepthBackend::kCpu, contact::DepthBackend::kExact};
  if (known_gpu_error().empty()) out.push_back(contact::DepthBackend::kGpu);
  return out;
}

void say_what_is_skipped(std::vector<Measurement>& out) {
  if (known_gpu_error().empty()) return;
  Measurement m;
  m.quantity = "gpu: SKIPPED, not measured: " + known_gpu_error();
  m.computed = m.exact = std::nan("");
  m.bar = std::numeric_limits<double>::infinity();
  out.push_back(m);
}

std::unique_ptr<contact::SampleSource> spoiled(std::unique_ptr<contact::SampleSource> source, Spoil spoil) {
  return std::make_unique<SpoiledSource>(std::move(source), std::move(spoil));
}

GridShift grid_shift(int i) {
  return {std::fmod(0.754877666 * (i + 1), 1.0), std::fmod(0.569840291 * (i + 1), 1.0)};
}

}  // namespace palpate::validation
