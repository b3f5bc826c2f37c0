#pragma once
#include <functional>
#include <optional>

#include "palpate/contact/obstacle.h"
#include "palpate/contact/sources.h"
#include "palpate/core/error.h"

namespace palpate::loop {

/// An exact shape that a frame carries: an obstacle, or a round tool.
struct Shape {
  contact::CharacteristicLengths lengths;
  std::function<TriMesh(double spacing)> surface{};  ///< null: it has no end
  std::function<Vec3(const Vec3& x)> onto{};         ///< its point nearest to x, in the frame
  int frame = -1;
  std::shared_ptr<contact::MovingFrame> motion;
  std::optional<Vec3> centre{};  ///< of a ball, in the frame
};

Shape round_tool(double radius, int frame, std::shared_ptr<contact::MovingFrame> motion);
/// @param force  takes the obstacle's frame
Shape shape_of(contact::ContactForce& force, const ObstacleSpec& obstacle);

/// Returns the points of a shape's own surface against a closed one, where they count.
/// @param error  wanted, as contact::point_spacing() has it
std::optional<contact::ShapePoints> own_points(const Shape& shape,
                                               const contact::CharacteristicLengths& other, double error);

/// Returns contact of a side with an obstacle.
/// @param shape  the obstacle's
std::unique_ptr<contact::SampleSource> obstacle_source(const Shape& shape, const ContactSpec& spec,
                                                       contact::ContactSide side, double candidate_gap,
                                                       double look_ahead, const ObstacleSpec& obstacle);

contact::DistanceOptions distance_options(const ContactSpec& spec, double look_ahead);
/// Says of which contact an error of its nearest points is.
[[noreturn]] void refuse_distance(const ContactSpec& spec, const Error& error);

}  // namespace palpate::loop
