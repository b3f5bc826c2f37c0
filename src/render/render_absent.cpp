#include "palpate/core/error.h"
#include "render/animation.h"
#include "render/available.h"
#include "render/field.h"
#include "render/labels.h"
#include "render/marks.h"
#include "render/panels.h"
#include "render/scene.h"

// Replacements of the drawing functions in a build without OpenGL.

namespace palpate::render {

bool available() { return false; }

void check_available() {
  fail(
      "this build draws no pictures; configure with -DPALPATE_WITH_GL=ON (packages libegl-dev, "
      "libepoxy-dev)");
}

void release_context() {}

Picture::Picture(int, int, Rgb) { check_available(); }
Picture draw(const Scene&, const Options&) {
  check_available();
  return {};
}
Picture draw_field(const Field&, const ColourScale&, const std::string&, int, const std::string&) {
  check_available();
  return {};
}
Picture beside(const std::vector<Picture>&) {
  check_available();
  return {};
}
Picture with_curve(const Picture&, const Curve&, double, int) {
  check_available();
  return {};
}
Picture draw_labelled(Scene, Options, const std::vector<Label>&) {
  check_available();
  return {};
}
Surface outline(const Points&, const Faces&, double, double) {
  check_available();
  return {};
}
Surface rings(const Vec3&, double) {
  check_available();
  return {};
}
Surface bar(const Vec3&, const Vec3&, double) {
  check_available();
  return {};
}
Surface dots(const Points&, double) {
  check_available();
  return {};
}
Fraction fraction_of(double) {
  check_available();
  return {};
}
struct AnimationWriter::Impl {};
AnimationWriter::AnimationWriter(const std::filesystem::path&, double) { check_available(); }
AnimationWriter::~AnimationWriter() = default;
void AnimationWriter::add(const Picture&) {}
void AnimationWriter::close() {}
void save_png(const Picture&, const std::filesystem::path&) { check_available(); }

}  // namespace palpate::render
