#pragma once
#include <memory>

#include "palpate/contact/obstacle.h"

namespace palpate::contact {

/// Makes the contact of one side with a ball: see make_analytic_source().
/// @param centre, radius  in the frame [m]
std::unique_ptr<SampleSource> make_sphere_source(ContactSide side, int frame,
                                                 std::shared_ptr<MovingFrame> motion, const Vec3& centre,
                                                 double radius, double candidate_gap,
                                                 double look_ahead = 0.0);

/// Returns a triangulated sphere about the origin: see ObstacleEntry::surface.
TriMesh sphere_surface(double radius, double spacing);

}  // namespace palpate::contact
