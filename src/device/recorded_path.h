#pragma once
#include <string>
#include <vector>

#include "palpate/device/device.h"

namespace palpate::device {

struct RecordedPose {
  double time;  ///< [s]
  Pose pose;
  std::uint32_t switches = 0;  ///< from then on, as HandleSample has them
};

/// A CSV file with the columns time_s, px_m, py_m, pz_m, qw, qx, qy, qz in any order, or force.csv of a run;
/// of either, a column "switches" where there is one.
/// @throws Error `FILE:LINE: column "NAME": ...`
std::vector<RecordedPose> read_recording(const std::string& path);

/// Between the lines; before the first and after the last it rests there.
HandleSample sample_recording(const std::vector<RecordedPose>& poses, double t);

}  // namespace palpate::device
