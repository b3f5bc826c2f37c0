#pragma once
#include <functional>
#include <optional>

#include "contact/sources.h"
#include "palpate/contact/contact_force.h"
#include "palpate/contact/obstacle.h"
#include "palpate/core/error.h"

namespace palpate::loop {

/// Exact shape attached to a frame: an obstacle, or a spherical tool.
struct Shape {
  contact::CharacteristicLengths lengths;
  std::function<TriMesh(double spacing)> surface{};  ///< null: unbounded
  std::function<Vec3(const Vec3& x)> onto{};         ///< Point of the shape nearest to x, in the frame.
  int frame = -1;
  std::shared_ptr<contact::MovingFrame> motion;
  std::optional<Vec3> centre{};  ///< Centre of a ball, in the frame.
};

/// Returns the shape of a spherical tool.
Shape round_tool(double radius, int frame, std::shared_ptr<contact::MovingFrame> motion);
/// Returns the shape of an obstacle.
/// @param force  receives the obstacle's frame
Shape shape_of(contact::ContactForce& force, const ObstacleSpec& obstacle);

/// Returns sample points on the shape for contact with a closed surface, if they are needed.
/// @param error  requested quadrature error, as for contact::point_spacing()
std::optional<contact::ShapePoints> own_points(const Shape& shape,
                                               const contact::CharacteristicLengths& other, double error);

/// Returns the contact source of a side with an obstacle.
/// @param shape  shape of the obstacle
std::unique_ptr<contact::SampleSource> obstacle_source(const Shape& shape, const ContactSpec& spec,
                                                       contact::ContactSide side, double candidate_gap,
                                                       double look_ahead, const ObstacleSpec& obstacle);

contact::DistanceOptions distance_options(const ContactSpec& spec, double look_ahead);
/// Rethrows an error of nearest-point contact with the names of its two sides.
[[noreturn]] void refuse_distance(const ContactSpec& spec, const Error& error);

}  // namespace palpate::loop
