#pragma once
#include <memory>

#include "palpate/contact/obstacle.h"
#include "palpate/core/pose.h"

namespace palpate::contact {

/// Makes the contact of one side with a cylinder along the z axis of `pose` between flat ends, centred at
/// `pose` in the frame: see make_analytic_source().
/// @param radius, length  [m]
std::unique_ptr<SampleSource> make_cylinder_source(ContactSide side, int frame,
                                                   std::shared_ptr<MovingFrame> motion, const Pose& pose,
                                                   double radius, double length, double candidate_gap,
                                                   double look_ahead = 0.0);

}  // namespace palpate::contact
