#pragma once
#include <string>

#include "palpate/loop/world.h"
#include "palpate/modes/modes.h"

namespace palpate::loop {

/// Computes the lowest modes of a scene at its start: held nodes are fixed, contact is as at the start, and
/// damping is ignored.
/// @throws Error if the scene has no soft bodies, or an unsymmetric tangent (friction)
modes::Modes find_modes(World& world, int count);

/// Amplitude of a drawn mode: largest displacement relative to the size of the bodies.
inline constexpr double kModeAmplitude = 0.1;

/// Returns the nodes of one body displaced by a mode, world [m].
Points displaced(const World& world, const Body& body, const modes::Modes& modes, int mode);

/// Writes the modes as a run (VTKHDF, store/run_file.h): step j is mode j at time j (counted from 1). Points
/// are displaced by kModeAmplitude; `velocity` is the velocity of the oscillation at its passage through rest
/// [m/s], `stress` the stress of the displaced shape [Pa].
void write_modes(World& world, const modes::Modes& modes, const std::string& path);

}  // namespace palpate::loop
