#pragma once
#include <string>
#include <vector>

#include "palpate/device/device.h"

namespace palpate::device {

/// One line of a recording.
struct RecordedPose {
  double time;  ///< Scene's time [s].
  Pose pose;
  std::uint32_t switches = 0;  ///< Bits as in HandleSample, from this time on.
};

/// Reads a CSV file (core/csv.h) with the columns time_s, px_m, py_m, pz_m, qw, qx, qy, qz in any order, or
/// force.csv of a run; either may have a column "switches". Column names may be in capitals. Lines with only
/// empty cells are skipped.
/// @param clock  map from the file's times to the scene's
/// @throws Error `FILE:LINE: column "NAME": ...`
std::vector<RecordedPose> read_recording(const std::string& path, const RecordingClock& clock = {});

/// Interpolates between the lines, so that each component of the position stays between its values at the two
/// lines; before the first and after the last line the handle is at rest.
HandleSample sample_recording(const std::vector<RecordedPose>& poses, double t);

}  // namespace palpate::device
