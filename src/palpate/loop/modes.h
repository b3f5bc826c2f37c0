#pragma once
#include <string>

#include "palpate/loop/world.h"
#include "palpate/modes/modes.h"

namespace palpate::loop {

/// The lowest modes of a scene at its start: held nodes held, contact as it is then, without damping.
/// @throws Error where the scene has no soft bodies, or its tangent is unsymmetric (friction)
modes::Modes find_modes(World& world, int count);

/// Amplitude of a drawn mode: its largest displacement is this part of the bodies' size.
inline constexpr double kModeAmplitude = 0.1;

/// Nodes of one body displaced by a mode, world [m].
Points displaced(const World& world, const Body& body, const modes::Modes& modes, int mode);

/// Writes the modes as a run (VTKHDF, store/run_file.h): step j is mode j at time j (its number, from 1).
/// Points are displaced by kModeAmplitude, `velocity` is that of the passage through rest [m/s], `stress`
/// that of the displaced shape [Pa].
void write_modes(World& world, const modes::Modes& modes, const std::string& path);

}  // namespace palpate::loop
