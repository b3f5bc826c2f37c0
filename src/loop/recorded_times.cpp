#include "recorded_times.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::loop {
namespace {

constexpr double kUnits[] = {1.0, 1e-3, 1e-6, 1e-9};  ///< Units of recorders [s].

/// Returns the unit for which the duration of the recording is closest to the scene's, by the absolute
/// logarithm of their ratio. A recording in seconds is taken for milliseconds if it is more than
/// sqrt(1000) = 32 times as long as the scene.
double likeliest_unit(double span, double duration_s) {
  return *std::min_element(std::begin(kUnits), std::end(kUnits), [&](double a, double b) {
    return std::abs(std::log(a * span / duration_s)) < std::abs(std::log(b * span / duration_s));
  });
}

}  // namespace

void check_recorded_times(const device::Device& handle, const DeviceSpec& spec, double duration_s) {
  const auto recorded = handle.recorded();
  if (!recorded) return;
  const auto [first, last] = *recorded;
  const bool apart = first >= duration_s || last < 0.0;
  const double span = last - first,
               unit = span > 0.0 && !spec.time_scale ? likeliest_unit(span, duration_s) : 1.0;
  if (!apart && unit == 1.0) return;
  std::string remedy;
  if (unit != 1.0)
    remedy = fmt::format("device.time_scale = {:g} if they are in units of {:g} s", unit, unit);
  const double begin = unit * (first - spec.time_offset_s);  // after scaling
  if (apart)
    remedy += fmt::format("{}device.time_offset_s = {:.12g} to start with the scene",
                          remedy.empty() ? "" : ", and ", 0.0 - begin);
  if (!apart) remedy += ", device.time_scale = 1 if they are seconds";
  fail(
      "device: {}: the times of the recording are {:.12g} to {:.12g} s, those of the scene 0 to {:g} s; set "
      "{}",
      spec.file, first, last, duration_s, remedy);
}

}  // namespace palpate::loop
