#pragma once
#include "palpate/mesh/mesh.h"

namespace palpate::haptic_stability {

/// Area of the cut of a closed surface with a plane [m^2].
/// @param normal  of the plane, a unit vector  @param height  of the plane along it [m]
double section_area(const TriMesh& surface, const Vec3& normal, double height);

/// The largest cut of a closed surface with a plane that is parallel to one of its faces [m^2]: what a tool
/// of that shape brings to bear on a wall at most, with that face laid on it.  Faces within ten degrees of a
/// larger one share its planes, which costs 1.5 % at most.
double largest_section(const TriMesh& surface);

}  // namespace palpate::haptic_stability
