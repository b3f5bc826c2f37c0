#include "contact_shapes.h"

#include <algorithm>
#include <cmath>

#include "scene/contact_sides.h"

namespace palpate::loop {

Shape round_tool(double radius, int frame, std::shared_ptr<contact::MovingFrame> motion) {
  return {{2.0 * radius, radius, 0.0},
          [radius](double spacing) { return contact::sphere_surface(radius, spacing); },
          [radius](const Vec3& x) { return Vec3(radius * x.normalized()); },
          frame,
          std::move(motion),
          Vec3::Zero()};
}

// The sample points of the other surface alone determine the overlap correctly until the other surface passes
// the middle of the shape, or contains the whole shape. If the shape is thicker than the other surface, the
// latter would have been passed through before. Otherwise the shape gets sample points, too, and each side
// has half of the weight.
//
// The number of triangles is limited to a hundred thousand, with some tens of MiB. A shape that needs more
// for the requested error gets larger triangles, up to ten times that error; a shape with a larger error,
// such as a table top thinner than the object on it, gets none. The error is proportional to the square of
// the edge length, and the number of triangles to its inverse.
std::optional<contact::ShapePoints> own_points(const Shape& shape,
                                               const contact::CharacteristicLengths& other, double error) {
  constexpr double kMostTriangles = 1e5, kMostError = 10.0;
  if (!shape.surface || shape.lengths.width >= other.width) return {};
  const TriMesh coarse = shape.surface(HUGE_VAL);
  double area = 0.0;
  for (Eigen::Index f = 0; f < coarse.faces.cols(); ++f) {
    const Mat3 x = coarse.vertices(Eigen::all, coarse.faces.col(f));
    area += 0.5 * (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm();
  }
  const double requested = contact::shape_spacing(shape.lengths, other, error),
               least = std::sqrt(area / (0.43 * kMostTriangles));  // triangle area: 0.43 e^2
  if (least * least > kMostError * requested * requested) return {};
  const double spacing = std::max(requested, least);
  return contact::ShapePoints{
      {shape.surface(spacing), shape.frame, shape.motion}, spacing, shape.onto, shape.centre};
}

Shape shape_of(contact::ContactForce& force, const ObstacleSpec& obstacle) {
  const contact::ObstacleEntry& entry = contact::obstacle_entry(obstacle);
  const Settings shape = contact::obstacle_shape(obstacle);
  Shape out{.lengths = entry.lengths(shape), .motion = contact::fixed_frame()};
  out.frame = force.add_frame(out.motion);
  out.onto = [&entry, shape](const Vec3& x) {
    const contact::Nearest at = entry.nearest(shape, x);
    return Vec3(x - at.gap * at.normal);
  };
  if (entry.surface) out.surface = [&entry, shape](double spacing) { return entry.surface(shape, spacing); };
  return out;
}

std::unique_ptr<contact::SampleSource> obstacle_source(const Shape& shape, const ContactSpec& spec,
                                                       contact::ContactSide side, double candidate_gap,
                                                       double look_ahead, const ObstacleSpec& obstacle) {
  if (scene::is_in_images(spec))
    fail(
        "contact {} - {}: method = \"image\" does not apply to a {}, which has exact gaps; use method = "
        "\"auto\"",
        spec.first, obstacle.name, obstacle.type);
  return contact::obstacle_entry(obstacle).make_source(std::move(side), shape.frame, shape.motion,
                                                       contact::obstacle_shape(obstacle), candidate_gap,
                                                       look_ahead);
}

contact::DistanceOptions distance_options(const ContactSpec& spec, double look_ahead) {
  return {.quadrature_error = spec.quadrature_error,
          .candidate_gap = spec.candidate_gap_m,
          .look_ahead = look_ahead};
}

void refuse_distance(const ContactSpec& spec, const Error& error) {
  fail("contact {} - {}: method \"distance\": {}", spec.first, spec.second, error.what());
}

}  // namespace palpate::loop
