#pragma once
#include <filesystem>
#include <vector>

#include "report/plot.h"

namespace palpate::report {

/// Motion of a hand and force of contact on its tool, tick by tick.
struct TouchMotion {
  std::vector<double> time_s, contact_n, speed_m_s;  ///< Speed of the handle
};

/// Returns the phases of the touch with the largest contact force: approach, until the tool touches; touch,
/// until the handle rests; hold, while it rests; release, until contact ends; free, until the end. A touch
/// without a rest has no hold and no release. Contact counts from 1 % of the largest force, and a handle
/// rests below 2 % of its largest speed, for at least 20 ms; a phase shorter than a thousandth of the whole
/// time is left out. Empty without contact.
std::vector<Span> touch_phases(const TouchMotion& motion);

/// Reads the motion of the first hand from haptic.h5; empty where the folder has no such file, or one of
/// another version.
TouchMotion read_touch(const std::filesystem::path& dir);

}  // namespace palpate::report
