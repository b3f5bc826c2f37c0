#pragma once
#include <string>
#include <vector>

#include "palpate/device/device.h"

namespace palpate::device {

struct RecordedPose {
  double time;  ///< the scene's [s]
  Pose pose;
  std::uint32_t switches = 0;  ///< from then on, as HandleSample has them
};

/// Reads a CSV file (core/csv.h) with the columns time_s, px_m, py_m, pz_m, qw, qx, qy, qz in any order, or
/// force.csv of a run; of either, a column "switches" where there is one.  Column names may be in capitals.
/// Lines of empty cells do not count.
/// @param clock  from the file's times to the scene's
/// @throws Error `FILE:LINE: column "NAME": ...`
std::vector<RecordedPose> read_recording(const std::string& path, const RecordingClock& clock = {});

/// Interpolates between the lines, in each component of the position between those of the two lines; before
/// the first and after the last it rests there.
HandleSample sample_recording(const std::vector<RecordedPose>& poses, double t);

}  // namespace palpate::device
