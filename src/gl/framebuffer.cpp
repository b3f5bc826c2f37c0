#include "gl/framebuffer.h"

#include <epoxy/gl.h>

#include <utility>

#include "gl/context.h"
#include "palpate/core/error.h"

namespace palpate::gl {
namespace {

struct FormatInfo {
  GLenum internal, external, type;
};

FormatInfo info(Format format) {
  switch (format) {
    case Format::kRgba8: return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case Format::kR32ui: return {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT};
    case Format::kR32f: return {GL_R32F, GL_RED, GL_FLOAT};
    case Format::kRgba32f: return {GL_RGBA32F, GL_RGBA, GL_FLOAT};
    case Format::kDepth32f: return {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT};
  }
  PALPATE_CHECK(false, "unknown texture format {}", static_cast<int>(format));
  return {};
}

int max_texture_size() {
  GLint size = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &size);
  return size;
}

}  // namespace

Texture::Texture(int width, int height, Format format) : width_(width), height_(height), format_(format) {
  const int largest = max_texture_size();
  if (width < 1 || height < 1 || width > largest || height > largest)
    fail("an image of {} x {} pixels cannot be created: this OpenGL device allows 1 to {} per edge", width,
         height, largest);
  // Classic binding calls: direct state access needs 4.5.
  glGenTextures(1, &id_);
  glBindTexture(GL_TEXTURE_2D, id_);
  glTexStorage2D(GL_TEXTURE_2D, 1, info(format).internal, width, height);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  set_linear(false);
}

Texture::~Texture() {
  if (id_) Context::destroy(ObjectKind::kTexture, id_);
}

Texture::Texture(Texture&& other) noexcept
    : id_(std::exchange(other.id_, 0)),
      width_(other.width_),
      height_(other.height_),
      format_(other.format_) {}

Texture& Texture::operator=(Texture&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(width_, other.width_);
  std::swap(height_, other.height_);
  std::swap(format_, other.format_);
  return *this;
}

void Texture::bind_unit(unsigned unit) const {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_2D, id_);
}

void Texture::upload(const void* pixels) {
  glBindTexture(GL_TEXTURE_2D, id_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, info(format_).external, info(format_).type,
                  pixels);
}

void Texture::set_linear(bool linear) {
  glBindTexture(GL_TEXTURE_2D, id_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, linear ? GL_LINEAR : GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, linear ? GL_LINEAR : GL_NEAREST);
}

Framebuffer::Framebuffer(int width, int height, const std::vector<Format>& colours, DepthBuffer depth)
    : width_(width), height_(height) {
  for (const Format format : colours) colours_.emplace_back(width, height, format);
  if (depth != DepthBuffer::kNone) depth_.emplace_back(width, height, Format::kDepth32f);
  glGenFramebuffers(1, &id_);
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  std::vector<GLenum> targets;
  for (const Texture& texture : colours_) {
    targets.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(targets.size()));
    glFramebufferTexture2D(GL_FRAMEBUFFER, targets.back(), GL_TEXTURE_2D, texture.id(), 0);
  }
  if (!depth_.empty())
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_[0].id(), 0);
  glDrawBuffers(static_cast<GLsizei>(targets.size()), targets.data());
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  PALPATE_CHECK(status == GL_FRAMEBUFFER_COMPLETE, "framebuffer of {} x {} is incomplete, status {:#x}",
                width, height, status);
}

Framebuffer::~Framebuffer() {
  if (id_) Context::destroy(ObjectKind::kFramebuffer, id_);
}

Framebuffer::Framebuffer(Framebuffer&& other) noexcept
    : id_(std::exchange(other.id_, 0)),
      width_(other.width_),
      height_(other.height_),
      colours_(std::move(other.colours_)),
      depth_(std::move(other.depth_)) {}

Framebuffer& Framebuffer::operator=(Framebuffer&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(width_, other.width_);
  std::swap(height_, other.height_);
  std::swap(colours_, other.colours_);
  std::swap(depth_, other.depth_);
  return *this;
}

void Framebuffer::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  glViewport(0, 0, width_, height_);
}

void Framebuffer::clear(int attachment, const float rgba[4]) {
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  glClearBufferfv(GL_COLOR, attachment, rgba);
}

void Framebuffer::clear(int attachment, std::uint32_t value) {
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  const GLuint values[4] = {value, 0, 0, 0};
  glClearBufferuiv(GL_COLOR, attachment, values);
}

void Framebuffer::clear_depth(float depth) {
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  glDepthMask(GL_TRUE);  // Clears respect the mask.
  glClearBufferfv(GL_DEPTH, 0, &depth);
}

const Texture& Framebuffer::depth() const {
  PALPATE_CHECK(!depth_.empty(), "this framebuffer has no depth");
  return depth_[0];
}

void Framebuffer::read_pixels(int attachment, unsigned format, unsigned type, void* out) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, id_);
  if (attachment >= 0) glReadBuffer(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(attachment));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, format, type, out);
  check_errors("read_pixels");
}

std::vector<std::uint8_t> Framebuffer::read_rgba8(int attachment) const {
  PALPATE_CHECK(colour(attachment).format() == Format::kRgba8, "attachment {} is not RGBA8", attachment);
  std::vector<std::uint8_t> pixels(4 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  read_pixels(attachment, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  return pixels;
}

std::vector<std::uint32_t> Framebuffer::read_r32ui(int attachment) const {
  PALPATE_CHECK(colour(attachment).format() == Format::kR32ui, "attachment {} is not R32UI", attachment);
  std::vector<std::uint32_t> pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  read_pixels(attachment, GL_RED_INTEGER, GL_UNSIGNED_INT, pixels.data());
  return pixels;
}

std::vector<float> Framebuffer::read_float(int attachment) const {
  const Format format = colour(attachment).format();
  PALPATE_CHECK(format == Format::kR32f || format == Format::kRgba32f, "attachment {} holds no floats",
                attachment);
  const std::size_t components = format == Format::kR32f ? 1 : 4;
  std::vector<float> pixels(components * static_cast<std::size_t>(width_) *
                            static_cast<std::size_t>(height_));
  read_pixels(attachment, info(format).external, GL_FLOAT, pixels.data());
  return pixels;
}

std::vector<float> Framebuffer::read_depth() const {
  PALPATE_CHECK(!depth_.empty(), "this framebuffer has no depth");
  std::vector<float> pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  read_pixels(-1, GL_DEPTH_COMPONENT, GL_FLOAT, pixels.data());
  return pixels;
}

}  // namespace palpate::gl
