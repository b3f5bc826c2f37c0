#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "haptic_stability/haptic_theory.h"
#include "palpate/scene/description.h"

namespace palpate::haptic_stability {

/// The stiffest virtual wall at one damping, by each verdict [N/m].  The coupling is the wall, the tool is
/// held; `in_contact` is the stiffest coupling instead, with the tool free and pressed on the scene's
/// stiffest contact (infinite: the scheme has no limit).
struct ZWidthRow {
  double damping = 0.0;  ///< [N s/m]
  double passive = 0.0, spectral = 0.0, delay_bound = 0.0, in_contact = 0.0;
  double simulated = 0.0;  ///< NaN: not simulated
};

/// Z-width of a loop (Colgate and Brown 1994): what it can render, over its damping.
struct ZWidth {
  std::vector<ZWidthRow> rows;  ///< simulated ones, ascending in damping
  std::vector<ZWidthRow> fine;  ///< theory alone, for curves
  bool stopped = false;

  /// Passive within stable, by theory and by simulation.
  bool passive_within_stable() const;
  /// Largest relative difference of the simulated limit from the spectral one.
  double largest_difference() const;
};

struct ZWidthOptions {
  int rows = 12;
  double duration_s = 4.0;  ///< of each simulation
  std::function<void(double fraction)> progress;
  const std::atomic<bool>* stop = nullptr;
};
ZWidth z_width(const HapticLoopModel& loop, const ZWidthOptions& options);

/// What a contact of the scene is worth at the tool: stiffness [N/m] and damping [N s/m].
struct ToolContact {
  double stiffness = 0.0, damping = 0.0;
};
struct ToolContactRange {
  ToolContact least, greatest;
};

/// The scene's tool, coupling and tick, and a device of default figures.  @throws Error for a scene without
/// a tool of ticks
HapticLoopModel loop_of(const scene::Description& description);
/// An estimate from the scene's keys (the derivation stands in scene_loop.cpp).
/// @throws Error for a scene whose tool touches nothing, or by springs at points
ToolContactRange contact_range(const scene::Description& description);

/// The loop about one axis, as the translation of a point at the lever a: with I/a^2, k/a^2 and b/a^2 for
/// inertia, stiffness and damping it is the same loop, and a is the tool's radius of gyration about that
/// axis, the one of its least moment of inertia.  Of a simulated hand the scene knows all figures; another
/// device has its mass and damping at a lever of 50 mm, the order of a stylus.  One that drives no torque is
/// held.
struct RotationalLoop {
  HapticLoopModel loop;    ///< masses of I/a^2 [kg], and so on
  ToolContactRange range;  ///< at the lever
  double lever_m = 0.0;    ///< a
  double inertia_kg_m2 = 0.0;
  bool driven = true;  ///< the device has torque
};
/// @param loop, range  of the translation
RotationalLoop rotational_loop_of(const scene::Description& description, const HapticLoopModel& loop,
                                  const ToolContactRange& range);

/// The scene's own loop at one contact.
struct OperatingPoint {
  std::string name;
  ToolContact contact;
  double series = 0.0;            ///< of coupling and contact [N/m]
  double radius = 0.0;            ///< spectral
  double largest_coupling = 0.0;  ///< at the scene's damping, by theory [N/m]
  bool simulated_stable = false;
  bool passive = false;  ///< the coupling as a wall is
  bool held = false;     ///< the device is, by the loop's arm
  /// @param scale  from [N/m] to `unit`
  std::string words(double tick_s, double scale = 1.0, const std::string& unit = "N/m") const;
};
/// Tool in the air, in the softest and in the stiffest contact.
std::vector<OperatingPoint> operating_points(HapticLoopModel loop, const ToolContactRange& range,
                                             double duration_s);

}  // namespace palpate::haptic_stability
