#pragma once
#include "palpate/mesh/mesh.h"

namespace palpate::haptic_stability {

/// Returns the area of the cut of a closed surface with a plane [m^2].
/// @param normal  normal of the plane, a unit vector
/// @param height  offset of the plane along its normal [m]
double section_area(const TriMesh& surface, const Vec3& normal, double height);

/// Returns the area of the largest cut of a closed surface with a plane parallel to one of its faces [m^2]:
/// the largest contact area of a tool of that shape with a wall, with that face laid on the wall. Faces
/// within ten degrees of a larger face share its planes, which costs 1.5 % at most.
double largest_section(const TriMesh& surface);

}  // namespace palpate::haptic_stability
