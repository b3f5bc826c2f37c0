#pragma once
#include <string>
#include <vector>

#include "contact/sources.h"
#include "faults.h"
#include "palpate/loop/run.h"

/// Scene of a rigid body on a rigid slab under gravity, run through the complete pipeline: the tool, with
/// zero coupling stiffness and damping, coupled monolithically with a block whose nodes are all fixed and
/// whose upper face is the plane z = 0.
namespace palpate::validation {

/// Returns the scene of a block `length` x `width` [m] with elements of `element_size` [m], whose edges have
/// at most sixteen points: contact by nearest points, implicit midpoint at 1e-4 s, contact queried every
/// millisecond. The caller sets shape, mass and position of the tool, gravity and the contact law.
scene::Description free_tool_scene(double length, double width, double element_size);

/// Contact of a sphere with radius R at the depth delta in a flat skin, by the points of both, each side with
/// half of its weight. The depth of a point of the sphere is its depth below the plane; the depth of a
/// point of the plane at the distance rho from the centre is R - rho. With c = R - delta
///     sphere   F = k int d dA                     = k pi R delta^2
///     plane    F = k int (R - rho) c/rho dA       = k 2 pi c int_c^R (R - rho) d rho = k pi c delta^2
/// where c/rho is the component along the plane's normal of the direction to the nearest point. Together, the
/// mean of both: k pi delta^2 (R - delta/2).
struct SphereOnSkin {
  double radius;
  /// Returns F/k [m^3].
  double force(double depth) const { return kPi * depth * depth * (radius - 0.5 * depth); }
  /// Returns the derivative of F/k with respect to depth [m^2].
  double stiffness(double depth) const { return kPi * (2.0 * radius * depth - 1.5 * depth * depth); }

 private:
  static constexpr double kPi = 3.14159265358979323846;
};

/// Runs the scene and returns its tick records, one per millisecond.
std::vector<loop::TickRecord> run_free_tool(const scene::Description& description,
                                            const Spoiler& seed_defect = {});

/// Returns the mean acceleration of the tool along x between two times [m/s^2].
double mean_acceleration(const std::vector<loop::TickRecord>& ticks, double from_s, double to_s);

}  // namespace palpate::validation
