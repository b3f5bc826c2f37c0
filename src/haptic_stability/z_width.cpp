#include "haptic_stability/z_width.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/error.h"

namespace palpate::haptic_stability {
namespace {

constexpr double kBisection = 2e-3;

ZWidthRow by_theory(const OneAxisLoop& free, const OneAxisLoop& held, double damping) {
  ZWidthRow row;
  row.damping = damping;
  row.passive = passive_stiffness(held, damping);
  row.spectral = spectral_stiffness(held, damping);
  row.delay_bound = delay_bound_stiffness(held, damping);
  row.in_contact = spectral_stiffness(free, damping);
  row.simulated = std::numeric_limits<double>::quiet_NaN();
  return row;
}

/// Returns zero and a geometric sequence up to 0.97 times the damping at which the loop is unstable at the
/// least stiffness.
std::vector<double> dampings(const OneAxisLoop& held, int count) {
  const double b = held.device.damping_n_s_m, last = 0.97 * largest_damping(held);
  const double first = std::min(b > 0.0 ? 0.1 * b : 1e-3 * last, 0.1 * last);
  std::vector<double> out = {0.0};
  for (int i = 0; i + 1 < count; ++i)
    out.push_back(first * std::pow(last / first, static_cast<double>(i) / (count - 2)));
  return out;
}

}  // namespace

bool ZWidth::passive_within_stable() const {
  const auto within = [](const ZWidthRow& row) {
    return row.passive <= row.spectral * (1.0 + 1e-6) &&
           !(row.passive > row.simulated * (1.0 + 2.0 * kBisection));  // NaN: not simulated
  };
  return std::all_of(rows.begin(), rows.end(), within) && std::all_of(fine.begin(), fine.end(), within);
}

double ZWidth::largest_difference() const {
  double largest = 0.0;
  for (const ZWidthRow& row : rows)
    if (std::isfinite(row.simulated) && row.spectral > 0.0)
      largest = std::max(largest, std::abs(row.simulated / row.spectral - 1.0));
  return largest;
}

ZWidth z_width(const OneAxisLoop& loop, const ZWidthOptions& options) {
  PALPATE_CHECK(options.rows >= 3, "{} rows", options.rows);
  OneAxisLoop held = loop;
  held.tool_held = true;
  ZWidth out;
  for (const double damping : dampings(held, 60)) out.fine.push_back(by_theory(loop, held, damping));
  for (const double damping : dampings(held, options.rows)) {
    out.stopped = options.stop && options.stop->load();
    if (out.stopped) break;
    ZWidthRow row = by_theory(loop, held, damping);
    row.simulated = simulated_stiffness(held, damping, options.duration_s, kBisection);
    out.rows.push_back(row);
    if (options.progress) options.progress(static_cast<double>(out.rows.size()) / options.rows);
  }
  return out;
}

std::string OperatingPoint::words(double tick_s, double scale, const std::string& unit) const {
  if (radius > 1.0 + 1e-9) {
    const double doubling = tick_s * std::log(2.0) / std::log(radius);
    return fmt::format("unstable: {} is above {:.4g} {}; a vibration doubles every {:.3g} s",
                       "the coupling's stiffness", scale * largest_coupling, unit, doubling);
  }
  const std::string limit =
      std::isinf(largest_coupling)
          ? "the coupling has no upper limit here"
          : fmt::format("the coupling may have up to {:.4g} {}", scale * largest_coupling, unit);
  if (passive) return fmt::format("passive: stable in any passive hand; {}", limit);
  return fmt::format("stable with the device {}, but not passive: {} hand can make it vibrate; {}",
                     held ? "held so" : "let go", held ? "another" : "some", limit);
}

std::vector<OperatingPoint> operating_points(OneAxisLoop loop, const ToolContactRange& range,
                                             double duration_s) {
  std::vector<OperatingPoint> out(3);
  out[0].name = "tool in the air";
  out[1].name = "softest contact";
  out[1].contact = range.least;
  out[2].name = "stiffest contact";
  out[2].contact = range.greatest;
  for (OperatingPoint& point : out) {
    loop.contact_stiffness_n_m = point.contact.stiffness;
    loop.contact_damping_n_s_m = point.contact.damping;
    const double k = loop.coupling_stiffness_n_m, K = point.contact.stiffness;
    point.series = k + K > 0.0 ? k * K / (k + K) : 0.0;
    point.radius = spectral_radius(loop);
    point.largest_coupling = spectral_stiffness(loop, loop.coupling_damping_n_s_m);
    point.simulated_stable = loop::simulate_virtual_wall(loop, duration_s).stable;
    point.passive = is_passive(loop);
    point.held = loop.device.held();
  }
  return out;
}

}  // namespace palpate::haptic_stability
