#pragma once
#include <memory>

#include "palpate/contact/obstacle.h"

namespace palpate::contact {

/// Makes the contact of one side with a half-space: see make_analytic_source().
/// @param point, normal  a point of the plane [m] and the outward direction, in the frame
std::unique_ptr<SampleSource> make_plane_source(ContactSide side, int frame,
                                                std::shared_ptr<MovingFrame> motion, const Vec3& point,
                                                const Vec3& normal, double candidate_gap,
                                                double look_ahead = 0.0);

}  // namespace palpate::contact
