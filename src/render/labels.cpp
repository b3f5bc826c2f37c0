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

Surface bar(const Vec3& from, const Vec3& to, double width) {
  const Vec3 along = (to - from).normalized(), side = 0.5 * width * along.unitOrthogonal(),
             up = along.cross(side);
  Surface out;
  out.points.resize(3, 8);
  for (int end = 0; end < 2; ++end)
    for (int k = 0; k < 4; ++k)
      out.points.col(4 * end + k) =
          (end == 0 ? from : to) + (k == 0 || k == 3 ? -1.0 : 1.0) * side + (k < 2 ? -1.0 : 1.0) * up;
  out.faces.resize(3, 12);
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    out.faces.col(2 * k) << k, next, 4 + next;
    out.faces.col(2 * k + 1) << k, 4 + next, 4 + k;
  }
  out.faces.col(8) << 0, 2, 1;
  out.faces.col(9) << 0, 3, 2;
  out.faces.col(10) << 4, 5, 6;
  out.faces.col(11) << 4, 6, 7;
  return out;
}

}  // namespace palpate::render
