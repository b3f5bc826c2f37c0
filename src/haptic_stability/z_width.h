#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "haptic_stability/haptic_theory.h"
#include "palpate/scene/description.h"

namespace palpate::haptic_stability {

/// Stiffest virtual wall at one damping, by each criterion [N/m]. The coupling is the wall and the tool is
/// held, except in `in_contact`: there the limit is the stiffest coupling, with the tool free and pressed on
/// the contact of the loop, the stiffest of the scene (infinite: the scheme has no limit).
struct ZWidthRow {
  double damping = 0.0;  ///< [N s/m]
  double passive = 0.0, spectral = 0.0, delay_bound = 0.0, in_contact = 0.0;
  double simulated = 0.0;  ///< NaN: not simulated
};

/// Z-width of a loop (Colgate and Brown 1994): the range of stiffnesses that the loop can render, over its
/// damping.
struct ZWidth {
  std::vector<ZWidthRow> rows;  ///< Rows with a simulation, in ascending order of damping
  std::vector<ZWidthRow> fine;  ///< Rows by theory alone, for curves
  bool stopped = false;         ///< Whether ZWidthOptions::stop ended the computation

  /// Returns whether the passive limit is at or below the stable limit in every row, by theory and by
  /// simulation.
  bool passive_within_stable() const;
  /// Returns the largest relative difference between the simulated and the spectral limit.
  double largest_difference() const;
};

struct ZWidthOptions {
  int rows = 12;
  double duration_s = 4.0;  ///< Simulated time per simulation [s]
  std::function<void(double fraction)> progress;
  const std::atomic<bool>* stop = nullptr;
};
/// Computes the Z-width of a loop, from zero damping to 0.97 times largest_damping().
/// @throws Error if options.rows < 3
ZWidth z_width(const OneAxisLoop& loop, const ZWidthOptions& options);

/// Stiffness [N/m] and damping [N s/m] of a contact of the scene at the tool.
struct ToolContact {
  double stiffness = 0.0, damping = 0.0;
};
/// Softest and stiffest contact of the tool.
struct ToolContactRange {
  ToolContact least, greatest;
};

/// Returns the loop model of a scene: its tool, coupling, tick and device; device figures that the scene does
/// not specify keep their defaults.
/// @throws Error for a scene without a tool, or with exchange.scheme = "monolithic", which has no ticks
OneAxisLoop loop_of(const scene::Description& description);
/// Estimates the range of contact stiffnesses at the tool from the keys of the scene (derivation:
/// scene_loop.cpp).
/// @throws Error for a scene without a contact of the tool, or with a contact of springs per point
ToolContactRange contact_range(const scene::Description& description);

/// Loop about one rotation axis, as the translation of a point at the lever a: with I/a^2, k/a^2 and b/a^2 as
/// inertia, stiffness and damping the equations are the same. a is the radius of gyration of the tool about
/// the axis of its least moment of inertia. The scene specifies all figures of a simulated hand; any other
/// device has its mass and damping at a lever of 50 mm, the order of a stylus. A device without torque output
/// is held.
struct RotationalLoop {
  OneAxisLoop loop;        ///< Rotational loop: masses are I/a^2 [kg], stiffness and damping k/a^2 and b/a^2
  ToolContactRange range;  ///< Contact at the lever
  double lever_m = 0.0;    ///< Lever a [m]
  double inertia_kg_m2 = 0.0;  ///< Least moment of inertia of the tool
  bool driven = true;          ///< Whether the device can output torque
};
/// Returns the loop about the axis of the least moment of inertia.
/// @param loop, range  loop model and contact range of the translation
RotationalLoop rotational_loop_of(const scene::Description& description, const OneAxisLoop& loop,
                                  const ToolContactRange& range);

/// Loop of the scene at one contact.
struct OperatingPoint {
  std::string name;
  ToolContact contact;
  double series = 0.0;            ///< Stiffness of coupling and contact in series [N/m]
  double radius = 0.0;            ///< Spectral radius of the loop
  double largest_coupling = 0.0;  ///< Largest stable coupling at the damping of the scene, by theory [N/m]
  bool simulated_stable = false;  ///< Whether the simulation stayed bounded
  bool passive = false;           ///< Whether the coupling is passive as a wall
  bool held = false;              ///< Whether the arm of the loop holds the device
  /// Returns the verdict on this point as a sentence.
  /// @param scale  conversion factor from [N/m] to `unit`
  std::string words(double tick_s, double scale = 1.0, const std::string& unit = "N/m") const;
};
/// Returns three operating points: tool in free air, in the softest and in the stiffest contact; each is
/// simulated for `duration_s`.
std::vector<OperatingPoint> operating_points(OneAxisLoop loop, const ToolContactRange& range,
                                             double duration_s);

}  // namespace palpate::haptic_stability
