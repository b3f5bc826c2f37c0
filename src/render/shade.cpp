#include "shade.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "average.h"
#include "corners.h"
#include "gl/buffer.h"
#include "gl/context.h"
#include "gl/framebuffer.h"
#include "gl/program.h"
#include "lights.h"
#include "tessellate.h"

namespace palpate::render {
namespace {

constexpr int kShadowSize = 2048;

/// Vertex data of a surface on the GPU.
struct Drawable {
  Drawable(const std::vector<Corner>& corners, const Surface* of)
      : surface(of), count(static_cast<int>(corners.size())) {
    buffer.upload(corners);
    array.attribute(0, buffer, 3, sizeof(Corner), offsetof(Corner, position));
    array.attribute(1, buffer, 3, sizeof(Corner), offsetof(Corner, normal));
    array.attribute(2, buffer, 1, sizeof(Corner), offsetof(Corner, value));
  }
  void draw() const {
    array.bind();
    glDrawArrays(GL_TRIANGLES, 0, count);
  }
  gl::Buffer buffer;
  gl::VertexArray array;
  const Surface* surface;
  int count;
};

Drawable ground_square(const Ground& ground, const Staging& staging) {
  const float reach = 12.0f * static_cast<float>(staging.radius),
              z = static_cast<float>(ground.z - staging.centre.z());
  std::vector<Corner> corners;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}})
    corners.push_back({{reach * static_cast<float>(x), reach * static_cast<float>(y), z}, {0, 0, 1}, -10.0f});
  return {corners, nullptr};
}

gl::Texture colour_table() {
  std::array<std::uint8_t, 4 * 256> bytes{};
  for (int i = 0; i < 256; ++i) {
    const Picture pixel(1, 1, ramp(i / 255.0));
    std::copy(pixel.rgba.begin(), pixel.rgba.end(), bytes.begin() + 4 * i);
  }
  gl::Texture table(256, 1, gl::Format::kRgba8);
  table.upload(bytes.data());
  table.set_linear(true);
  return table;
}

Eigen::Vector3f vector_of(Rgb c) { return {c.r, c.g, c.b}; }

/// Draws one picture; owns its GPU objects.
class Shader {
 public:
  Shader(const Scene& scene, const Staging& staging, const Options& options);
  Picture run();

 private:
  void draw_shadows();
  void set_common(gl::Program& program);
  void draw_ground();
  void draw_surface(const Drawable& drawable);
  void draw_transparent(const Drawable& drawable);
  std::vector<const Drawable*> transparent_from_behind() const;

  const Scene& scene_;
  const Staging& staging_;
  const Options& options_;
  Camera camera_;  // relative to the scene's centre
  Lights lights_;
  Eigen::Matrix4f view_, light_;
  gl::Program surface_{"render/surface.vert", "render/surface.frag"},
      ground_{"render/surface.vert", "render/ground.frag"},
      shadow_{"render/shadow.vert", "render/shadow.frag"};
  gl::Texture table_ = colour_table();
  gl::Framebuffer shadow_map_{kShadowSize, kShadowSize, {}, gl::DepthBuffer::kDepth};
  std::vector<Drawable> drawables_;
};

Shader::Shader(const Scene& scene, const Staging& staging, const Options& options)
    : scene_(scene),
      staging_(staging),
      options_(options),
      camera_(staging.camera),
      lights_(lights_of(staging.camera)) {
  camera_.eye -= staging.centre;
  camera_.target -= staging.centre;
  view_ = view_projection(camera_, static_cast<double>(options.width) / options.height).cast<float>();
  light_ = light_projection(lights_.key, staging.radius).cast<float>();
  const Viewport viewport{view_, options.width, options.height};
  for (const Surface& surface : scene.surfaces)
    if (surface.faces.cols() > 0)
      drawables_.emplace_back(
          tessellated(corners(surface, staging.scale, staging.centre), surface.faces, viewport), &surface);
}

void Shader::draw_shadows() {
  shadow_map_.bind();
  shadow_map_.clear_depth(1.0f);
  shadow_.use();
  shadow_.set("light_projection", light_);
  if (options_.lit)
    for (const Drawable& d : drawables_)
      if (d.surface->casts_shadow) d.draw();
}

void Shader::set_common(gl::Program& program) {
  program.use();
  program.set("view_projection", view_);
  program.set("light_projection", light_);
  program.set("lit", options_.lit ? 1 : 0);
  program.set("shadow_map", 1);
  shadow_map_.depth().bind_unit(1);
}

void Shader::draw_ground() {
  if (!scene_.ground || camera_.eye.z() + staging_.centre.z() <= scene_.ground->z) return;
  set_common(ground_);
  ground_.set("background", vector_of(options_.background));
  ground_.set("grid_origin", Eigen::Vector2f((-staging_.centre.head<2>()).cast<float>()));
  ground_.set("spacing", static_cast<float>(staging_.grid_spacing));
  ground_.set("fade_radius", 5.0f * static_cast<float>(staging_.radius));
  ground_.set("shadow_radius", 0.045f);
  // Offset backwards in depth, so that surfaces that touch the ground stay visible.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.0f, 4.0f);
  ground_square(*scene_.ground, staging_).draw();
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void Shader::draw_surface(const Drawable& drawable) {
  set_common(surface_);
  surface_.set("plain_colour", vector_of(drawable.surface->colour));
  surface_.set("opacity", static_cast<float>(drawable.surface->opacity));
  surface_.set("parallel", camera_.perspective ? 0 : 1);
  surface_.set("eye",
               Eigen::Vector3f(
                   (camera_.perspective ? camera_.eye : Vec3(camera_.eye - camera_.target)).cast<float>()));
  surface_.set("key_light", Eigen::Vector3f(lights_.key.cast<float>()));
  surface_.set("fill_light", Eigen::Vector3f(lights_.fill.cast<float>()));
  surface_.set("shadow_radius", 0.008f);
  surface_.set("colour_map", 0);
  table_.bind_unit(0);
  drawable.draw();
}

/// Draws depth first, then colour where depth is equal: only the layer nearest to the eye is blended, in any
/// order of triangles.
void Shader::draw_transparent(const Drawable& drawable) {
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw_surface(drawable);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthFunc(GL_LEQUAL);
  draw_surface(drawable);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
}

/// Returns translucent surfaces sorted back to front by their centroids, for blending.
std::vector<const Drawable*> Shader::transparent_from_behind() const {
  std::vector<std::pair<double, const Drawable*>> order;
  const Vec3 forward = (camera_.target - camera_.eye).normalized();
  for (const Drawable& d : drawables_)
    if (d.surface->opacity < 1.0)
      order.emplace_back(-forward.dot(Vec3(d.surface->points.rowwise().mean())), &d);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& p, const auto& q) { return p.first < q.first; });
  std::vector<const Drawable*> out;
  for (const auto& [depth, d] : order) out.push_back(d);
  return out;
}

/// Sets the whole GL state that drawing depends on; earlier users of the context may have left any other.
void set_state() {
  for (const int off : {GL_BLEND, GL_CULL_FACE, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL})
    glDisable(static_cast<GLenum>(off));
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

Picture Shader::run() {
  set_state();
  draw_shadows();
  gl::Framebuffer target(options_.width * options_.supersampling, options_.height * options_.supersampling,
                         {gl::Format::kRgba8}, gl::DepthBuffer::kDepth);
  const float background[4] = {options_.background.r, options_.background.g, options_.background.b, 1.0f};
  target.bind();
  target.clear(0, background);
  target.clear_depth(1.0f);
  for (const Drawable& d : drawables_)
    if (d.surface->opacity >= 1.0) draw_surface(d);
  draw_ground();
  for (const Drawable* d : transparent_from_behind()) draw_transparent(*d);
  glDisable(GL_DEPTH_TEST);
  gl::check_errors("render::draw");
  return average(target.read_rgba8(0), options_.width, options_.height, options_.supersampling);
}

}  // namespace

Picture shade(const Scene& scene, const Staging& staging, const Options& options) {
  gl::Context::shared();
  return Shader(scene, staging, options).run();
}

}  // namespace palpate::render
