#pragma once
#include <string>
#include <vector>

#include "contact/sources.h"
#include "faults.h"
#include "palpate/loop/run.h"

/// A rigid body on a rigid slab under gravity, through everything a scene goes through: the tool without its
/// coupling (stiffness and damping zero), in one system with a block whose nodes are all held, whose upper
/// face is the plane z = 0.
namespace palpate::validation {

/// Block `length` x `width`, of elements of `element_size`, whose edges get sixteen points at most [m];
/// contact by nearest points, implicit midpoint at 1e-4 s, contact looked for anew every millisecond.  The
/// caller gives the tool its shape, mass and place, the scene its gravity and the contact its law.
scene::Description free_tool_scene(double length, double width, double element_size);

/// Contact of a sphere of radius R at the depth delta in a flat skin, by the points of both: each side with
/// half of its weight.  A point of the sphere is as deep as it lies below the plane; a point of the plane as
/// deep as it lies inside the sphere, at the distance rho from the centre, R - rho.  With c = R - delta
///     sphere   F = k int d dA                     = k pi R delta^2
///     plane    F = k int (R - rho) c/rho dA       = k 2 pi c int_c^R (R - rho) d rho = k pi c delta^2
/// as the nearest point lies across the plane by c/rho of the way: together k pi delta^2 (R - delta/2).
struct SphereOnSkin {
  double radius;
  /// F/k [m^3]
  double force(double depth) const { return kPi * depth * depth * (radius - 0.5 * depth); }
  /// its derivative [m^2]
  double stiffness(double depth) const { return kPi * (2.0 * radius * depth - 1.5 * depth * depth); }

 private:
  static constexpr double kPi = 3.14159265358979323846;
};

/// What each tick showed, a millisecond apart.
std::vector<loop::TickRecord> run_free_tool(const scene::Description& description,
                                            const Spoiler& seed_defect = {});

/// Mean acceleration of the tool along x between two times [m/s^2].
double mean_acceleration(const std::vector<loop::TickRecord>& ticks, double from_s, double to_s);

}  // namespace palpate::validation
