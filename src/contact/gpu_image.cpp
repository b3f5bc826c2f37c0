#include "contact/gpu_image.h"

#include <algorithm>

#include "palpate/contact/gpu_available.h"
#include "palpate/core/error.h"
#include "palpate/gl/commands.h"
#include "palpate/gl/context.h"

namespace palpate::contact {
namespace {

int opened(int pixels) {
  gl::Context::shared();  // before any member is made
  return pixels;
}

}  // namespace

GpuImage::Surface::Surface(int pixels)
    : target(pixels, pixels, {gl::Format::kR32ui}, gl::DepthBuffer::kDepthAndStencil) {
  vertices.upload(nullptr, 0);
  triangles.upload(nullptr, 0);
  layout.attribute(0, vertices, 3, 3 * sizeof(float));
  layout.indices(triangles);
}

GpuImage::GpuImage(int pixels)
    : pixels_(opened(pixels)),
      draw_("contact/patch.vert", "contact/patch.frag"),
      pair_("contact/pair.comp"),
      a_(pixels),
      b_(pixels) {
  list_.reserve(sizeof(FacePair) * static_cast<std::size_t>(pixels) * static_cast<std::size_t>(pixels));
  gl::check_errors("making the contact images");
}

// Clip coordinates of an orthographic camera: x = 2 (u - u0)/(width pixel) - 1, the same for y, z = 2 (w -
// near)/(far - near) - 1.
void GpuImage::draw(Surface& surface, const Patch& patch, const ContactCamera& camera, bool keep_least) {
  surface.positions.resize(static_cast<std::size_t>(patch.uvw.size()));
  std::transform(patch.uvw.data(), patch.uvw.data() + patch.uvw.size(), surface.positions.begin(),
                 [](double x) { return static_cast<float>(x); });
  surface.indices.resize(3 * patch.visible.size());
  for (std::size_t f = 0; f < patch.visible.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      surface.indices[3 * f + k] =
          static_cast<std::uint32_t>((*patch.faces)(static_cast<Eigen::Index>(k), patch.visible[f]));
  surface.vertices.upload(surface.positions);
  surface.triangles.upload(surface.indices);

  const double sx = 2.0 / (camera.width * camera.pixel), sy = 2.0 / (camera.height * camera.pixel),
               sz = 2.0 / (camera.far - camera.near);
  draw_.set("scale", Vec3(sx, sy, sz).cast<float>().eval());
  draw_.set("shift",
            Vec3(-1.0 - sx * camera.u0, -1.0 - sy * camera.v0, -1.0 - sz * camera.near).cast<float>().eval());
  surface.target.bind();
  gl::set_plain_state(camera.width, camera.height,
                      keep_least ? gl::Keep::kLeastDepth : gl::Keep::kGreatestDepth);
  gl::cull_and_count(keep_least);  // of a those that face up
  surface.target.clear(0, std::uint32_t{0});
  surface.target.clear_depth(keep_least ? 1.0f : 0.0f);
  draw_.use();
  gl::draw_triangles(surface.layout, surface.indices.size());
}

void GpuImage::append_pairs(const ContactCamera& camera, double candidate_gap) {
  constexpr int kGroup = 16;  // local_size of pair.comp
  // of the slab: single precision and the rasteriser's own grid; the exact gap decides later
  constexpr double kDepthRounding = 1e-4;
  const std::uint32_t none = 0;
  count_.upload(&none, sizeof none);
  a_.target.colour(0).bind_unit(0);
  b_.target.colour(0).bind_unit(1);
  a_.target.depth().bind_unit(2);
  b_.target.depth().bind_unit(3);
  a_.target.stencil().bind_unit(4);
  b_.target.stencil().bind_unit(5);
  count_.bind_storage(0);
  list_.bind_storage(1);
  pair_.set("width", camera.width);
  pair_.set("height", camera.height);
  pair_.set("largest_gap", static_cast<float>(candidate_gap / (camera.far - camera.near) + kDepthRounding));
  gl::dispatch(pair_, (camera.width + kGroup - 1) / kGroup, (camera.height + kGroup - 1) / kGroup);
}

void GpuImage::find_pairs(const Patch& a, const Patch& b, const ContactCamera& camera, double candidate_gap,
                          std::vector<FacePair>& pairs, std::vector<std::uint32_t>& layered) {
  pairs.clear();
  layered.clear();
  if (!camera.sees_something()) return;
  PALPATE_CHECK(camera.width <= pixels_ && camera.height <= pixels_, "contact image of {} x {} in one of {}",
                camera.width, camera.height, pixels_);
  gl::Context::shared();
  draw(a_, a, camera, true);
  draw(b_, b, camera, false);
  append_pairs(camera, candidate_gap);
  std::uint32_t count = 0;
  count_.read(&count, sizeof count);
  pairs.resize(count);
  if (count > 0) list_.read(pairs.data(), count * sizeof(FacePair));
  gl::check_errors("the contact images");
  std::sort(pairs.begin(), pairs.end(), [](const FacePair& p, const FacePair& q) { return p.at < q.at; });
  constexpr std::uint32_t kLayered = 1u << 31;  // as in pair.comp
  for (FacePair& pair : pairs) {
    if (pair.a & kLayered) layered.push_back(pair.at);
    pair.a &= ~kLayered;
  }
}

bool gpu_available() { return true; }

std::unique_ptr<DepthImage> make_gpu_image(int pixels) { return std::make_unique<GpuImage>(pixels); }

}  // namespace palpate::contact
