#include "labels.h"

#include "canvas.h"
#include "overlay.h"
#include "palpate/core/error.h"

namespace palpate::render {
namespace {

/// Returns the camera with which draw() would frame the scene.
Camera camera_for(const Scene& scene, const Options& options) {
  Eigen::Index count = 0;
  for (const Surface& surface : scene.surfaces) count += surface.points.cols();
  if (count == 0) fail("picture: there is nothing to show: no surface has a point");
  Points all(3, count);
  Eigen::Index at = 0;
  for (const Surface& surface : scene.surfaces) {
    all.middleCols(at, surface.points.cols()) = surface.points;
    at += surface.points.cols();
  }
  return framed(all, options.view, static_cast<double>(options.width) / options.height,
                margins_of(scene, options, std::nullopt));
}

}  // namespace

Picture draw_labelled(Scene scene, Options options, const std::vector<Label>& labels) {
  for (Surface& surface : scene.surfaces) surface.values.resize(0);
  if (!options.camera) options.camera = camera_for(scene, options);
  const double width = options.width, height = options.height, size = height / 45.0;
  const Eigen::Matrix4d project = view_projection(*options.camera, width / height);
  Canvas canvas(draw(scene, options));
  for (const Label& label : labels) {
    const Eigen::Vector4d clip = project * label.at.homogeneous();
    if (!(clip.w() > 0.0)) continue;  // behind the eye
    const double x = 0.5 * width * (1.0 + clip.x() / clip.w()),
                 y = 0.5 * height * (1.0 - clip.y() / clip.w()), length = canvas.text_width(label.text, size);
    canvas.set_colour(options.background, 0.75);
    canvas.fill_rectangle(x - 0.5 * length - 0.2 * size, y - 0.65 * size, length + 0.4 * size, 1.3 * size);
    canvas.set_colour(label.colour);
    canvas.text(label.text, x - 0.5 * length, y + 0.35 * size, size);
  }
  return canvas.result();
}

}  // namespace palpate::render
