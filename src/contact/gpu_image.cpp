#include "contact/gpu_image.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "core/clock.h"
#include "gl/commands.h"
#include "gl/context.h"
#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

constexpr std::uint32_t kNone = ~0u;
constexpr int kUsualEdge = 512;  // Smallest edge of the render targets [pixels].
// Offset of the list, which follows the count.
constexpr std::size_t kListOffset = gl::MappedBuffer::kStorageAlignment;

const char* opened(const char* name) {
  const gl::Context& context = gl::Context::shared();  // Created before any member.
  if (gl::vertex_storage_blocks() < 1)
    fail(
        "contact on the GPU needs storage buffers in vertex shaders, which {} does not support; use method = "
        "\"distance\"",
        context.info().renderer);
  return name;
}

std::size_t aligned(std::size_t bytes) {
  constexpr std::size_t kTo = gl::MappedBuffer::kStorageAlignment;
  return (bytes + kTo - 1) / kTo * kTo;
}

}  // namespace

GpuImage::GpuImage()
    : draw_(opened("contact/skin.vert"), "contact/skin.frag"),
      pair_("contact/pair.comp"),
      draws_sent_(gl::MappedBuffer::For::kUpload),
      tiles_sent_(gl::MappedBuffer::For::kUpload),
      pairs_found_(gl::MappedBuffer::For::kReadback) {
  gl::check_errors("making the contact images");
}

void GpuImage::prepare(ImageSide& a, ImageSide& b) {
  constexpr int kTile = 16;
  static constexpr std::array<int, 1> kFirst = {0};
  const Patch nothing;
  DepthRequest request;
  request.a = request.b = &nothing;
  request.camera = {.pixel = 1.0, .width = kTile, .height = kTile, .far = 1.0};
  request.from_a = {.side = &a, .faces = kFirst};
  request.from_b = {.side = &b, .faces = kFirst};
  pairs_found_.reserve(kListOffset + sizeof(Found) * kUsualEdge * kUsualEdge);
  DepthRequest* const asked = &request;
  answer({&asked, 1});
}

void GpuImage::answer(std::span<DepthRequest* const> requests) {
  gl::Context::shared();
  times_ = {};
  while (!requests.empty()) {
    const std::size_t taken = atlas_.pack(requests, gl::largest_texture());
    answer_tiles(requests.first(taken));
    requests = requests.subspan(taken);
  }
}

void GpuImage::answer_tiles(std::span<DepthRequest* const> requests) {
  for (DepthRequest* request : requests) request->pairs.clear();
  if (atlas_.pixels() == 0) return;
  const double start = wall_seconds();
  send(requests);
  const double upload = wall_seconds() - start;
  instants_.mark(0);
  draw(requests, true);
  draw(requests, false);
  instants_.mark(1);
  append_pairs();
  instants_.mark(2);
  gl::finish("the contact images");
  distribute_pairs(requests);
  // The device's clock is not the host's: measured stages are limited to the time that the host waited.
  const double waited = wall_seconds() - start - upload;
  const double passes = std::min(instants_.seconds(0, 1), waited);
  const double gather = std::min(instants_.seconds(1, 2), waited - passes);
  times_.upload += upload;
  times_.passes += passes;
  times_.gather += gather;
  times_.readback += waited - passes - gather;
}

/// Uploads moved points, tiles, and the ranges of faces to draw.
void GpuImage::send(std::span<DepthRequest* const> requests) {
  draws_.clear();
  layers_.clear();
  for (const DepthRequest* request : requests) {
    layers_.push_back(add_draws(request->from_a));
    layers_.push_back(add_draws(request->from_b));
  }
  for (std::size_t i = 0; i < requests.size(); ++i) {
    surfaces_.send_points(*layers_[2 * i].surface, *requests[i]->from_a.side);
    surfaces_.send_points(*layers_[2 * i + 1].surface, *requests[i]->from_b.side);
  }
  const std::size_t draw_bytes = draws_.size() * sizeof(Draw);
  draws_sent_.reserve(std::max(draw_bytes, sizeof(Draw)));
  std::memcpy(draws_sent_.data(), draws_.data(), draw_bytes);
  const auto tiles = atlas_.tiles();
  const auto blocks = atlas_.blocks();
  tiles_sent_.reserve(aligned(tiles.size_bytes()) + blocks.size_bytes());
  std::memcpy(tiles_sent_.data(), tiles.data(), tiles.size_bytes());
  std::memcpy(tiles_sent_.data() + aligned(tiles.size_bytes()), blocks.data(), blocks.size_bytes());
}

/// Adds one draw for each range of the region's faces that is contiguous in the surface's order.
GpuImage::Layer GpuImage::add_draws(const PatchSource& source) {
  GpuSurface& surface = surfaces_.at(*source.side);
  Layer layer{&surface, draws_.size(), 0};
  int last = -2;
  for (std::size_t i = 0; i < source.faces.size(); ++i) {
    const int place = surface.place_of_face[static_cast<std::size_t>(source.faces[i])];
    if (place != last + 1)
      draws_.push_back({0, 1, 3 * static_cast<std::uint32_t>(place), 0,
                        static_cast<std::uint32_t>(draws_.size()), static_cast<std::uint32_t>(i)});
    draws_.back().count += 3;
    last = place;
  }
  layer.draw_count = draws_.size() - layer.first_draw;
  return layer;
}

// With the points x of a surface about its origin o, in a frame with the pose (R, t), contact axes (A, c) and
// an orthographic camera, clip coordinates are s . (A^T (R (o + x) + t - c)) + d, where s = 2/(width pixel)
// and d = -1 - s u0 along u, correspondingly along v, and s = 2/(far - near), d = -1 - s near along w.
void GpuImage::draw(std::span<DepthRequest* const> requests, bool of_a) {
  std::unique_ptr<gl::Framebuffer>& target = of_a ? target_a_ : target_b_;
  if (!target || target->width() < atlas_.width() || target->height() < atlas_.height()) {
    const int width = std::max(atlas_.width(), target ? target->width() : kUsualEdge),
              height = std::max(atlas_.height(), target ? target->height() : kUsualEdge);
    target.reset();
    target = std::make_unique<gl::Framebuffer>(width, height, std::vector{gl::Format::kR32ui},
                                               gl::DepthBuffer::kDepth);
  }
  target->bind();
  gl::set_plain_state(atlas_.width(), atlas_.height(),
                      of_a ? gl::Keep::kLeastDepth : gl::Keep::kGreatestDepth);
  gl::cull(of_a);  // Culls upward faces of a, downward faces of b.
  gl::set_window(0, 0, atlas_.width(), atlas_.height());
  target->clear(0, std::uint32_t{0});
  target->clear_depth(of_a ? 1.0f : 0.0f);
  draw_.use();
  surfaces_.bind_points(0);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const DepthRequest& request = *requests[i];
    const AtlasTile& tile = atlas_.tiles()[i];
    if (tile.width == 0) continue;
    const Layer& layer = layers_[2 * i + (of_a ? 0 : 1)];
    const ContactCamera& camera = request.camera;
    const Pose pose = (of_a ? request.from_a : request.from_b).side->points_pose();
    const Vec3 scale(2.0 / (camera.width * camera.pixel), 2.0 / (camera.height * camera.pixel),
                     2.0 / (camera.far - camera.near)),
        low(camera.u0, camera.v0, camera.near);
    const Mat3 turn = request.axes.to_world.transpose() * pose.rotation.toRotationMatrix();
    const Vec3 origin = request.axes.in_axes(pose * layer.surface->points->origin);
    std::array<Eigen::Vector4f, 3> rows;
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector4d row;
      row << scale[k] * turn.row(k).transpose(), scale[k] * (origin[k] - low[k]) - 1.0;
      rows[static_cast<std::size_t>(k)] = row.cast<float>();
    }
    draw_.set("camera", rows);
    draw_.set("first_point", layer.surface->points->first);
    gl::set_window(static_cast<int>(tile.x), static_cast<int>(tile.y), camera.width, camera.height);
    layer.surface->layout.attribute_per_draw(2, draws_sent_, sizeof(Draw), offsetof(Draw, first_face));
    gl::draw_ranges(layer.surface->layout, draws_sent_, layer.first_draw * sizeof(Draw), layer.draw_count,
                    sizeof(Draw));
  }
  // No viewport for later drawing by other code.
  gl::set_plain_state(atlas_.width(), atlas_.height(), gl::Keep::kAll);
}

void GpuImage::append_pairs() {
  pairs_found_.reserve(kListOffset + sizeof(Found) * atlas_.pixels());
  const std::uint32_t none = 0;
  count_.upload(&none, sizeof none);
  target_a_->colour(0).bind_unit(0);
  target_b_->colour(0).bind_unit(1);
  target_a_->depth().bind_unit(2);
  target_b_->depth().bind_unit(3);
  const std::size_t tile_bytes = atlas_.tiles().size_bytes();
  tiles_sent_.bind_storage(1, 0, tile_bytes);
  tiles_sent_.bind_storage(2, aligned(tile_bytes), atlas_.blocks().size_bytes());
  count_.bind_storage(3);
  pairs_found_.bind_storage(4, kListOffset, pairs_found_.capacity() - kListOffset);
  constexpr int kRow = 256;  // Work groups.
  const int groups = static_cast<int>(atlas_.blocks().size());
  gl::dispatch(pair_, std::min(groups, kRow), (groups + kRow - 1) / kRow);
  gl::copy(count_, pairs_found_, sizeof none);
}

namespace {

/// Computes, per face of the region, its index in the patch's `visible`, or -1.
void invert(const Patch& patch, const PatchSource& source, std::vector<std::int32_t>& out) {
  out.assign(source.faces.size(), -1);
  for (std::size_t i = 0; i < patch.visible.size(); ++i)
    out[static_cast<std::size_t>(patch.visible[i])] = static_cast<std::int32_t>(i);
}

}  // namespace

void GpuImage::distribute_pairs(std::span<DepthRequest* const> requests) {
  std::uint32_t count = 0;
  std::memcpy(&count, pairs_found_.data(), sizeof count);
  PALPATE_CHECK(count <= atlas_.pixels(), "{} pairs of {} pixels", count, atlas_.pixels());
  if (found_.size() < requests.size()) found_.resize(requests.size());
  for (auto& list : found_) list.clear();
  const std::byte* in = pairs_found_.data() + kListOffset;
  for (std::uint32_t i = 0; i < count; ++i, in += sizeof(Found)) {
    Found pair;
    std::memcpy(&pair, in, sizeof pair);
    found_[pair.at >> 24].push_back({pair.at & 0xffffffu, pair.a, pair.b});
  }
  for (std::size_t i = 0; i < requests.size(); ++i) {
    DepthRequest& request = *requests[i];
    const std::vector<Found>& list = found_[i];
    if (list.empty()) continue;
    invert(*request.a, request.from_a, visible_a_);
    invert(*request.b, request.from_b, visible_b_);
    const AtlasTile& tile = atlas_.tiles()[i];
    // At most one pair per pixel: no comparison is needed to sort them.
    found_at_.assign(static_cast<std::size_t>(tile.width) * tile.height, kNone);
    for (std::size_t k = 0; k < list.size(); ++k) found_at_[list[k].at] = static_cast<std::uint32_t>(k);
    request.pairs.reserve(list.size());
    for (const std::uint32_t k : found_at_) {
      if (k == kNone) continue;
      const Found& pair = list[k];
      const std::int32_t a = visible_a_[pair.a], b = visible_b_[pair.b];
      if (a < 0 || b < 0) continue;  // Outside the window in double precision.
      request.pairs.push_back({pair.at, static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
    }
  }
}

std::unique_ptr<DepthImage> make_depth_image() { return std::make_unique<GpuImage>(); }

}  // namespace palpate::contact
