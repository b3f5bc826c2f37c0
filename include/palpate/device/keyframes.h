#pragma once
#include <string>
#include <vector>

#include "palpate/device/device.h"

namespace palpate::device {

/// Evaluates the path through keyframes; before the first and after the last keyframe it is at rest.
/// Rotations interpolate the rotation vector between neighbouring keyframes (a fixed axis per segment), so
/// twist and acceleration are the exact derivatives of the pose. At the time of a keyframe the segment that
/// starts there applies. At a "step" or a kink of "linear" there is no derivative: only the pose or the twist
/// jumps.
/// @throws Error for an empty path
HandleSample sample_keyframes(const std::vector<KeyframeSpec>& keyframes, double t);

/// Checks a path: at least one keyframe, all values finite, times strictly ascending, known interpolations,
/// and rotations of at most half a turn between neighbouring keyframes (beyond that the direction is
/// ambiguous).
/// @throws Error beginning with `where`, e.g. "device"
void check_keyframes(const std::vector<KeyframeSpec>& keyframes, const std::string& where);

}  // namespace palpate::device
