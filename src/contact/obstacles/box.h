#pragma once
#include <memory>

#include "palpate/contact/obstacle.h"
#include "palpate/core/pose.h"

namespace palpate::contact {

/// Makes the contact of one side with a box centred at `pose` in the frame: see make_analytic_source().
/// @param size  edge lengths [m]
std::unique_ptr<SampleSource> make_box_source(ContactSide side, int frame,
                                              std::shared_ptr<MovingFrame> motion, const Pose& pose,
                                              const Vec3& size, double candidate_gap,
                                              double look_ahead = 0.0);

}  // namespace palpate::contact
