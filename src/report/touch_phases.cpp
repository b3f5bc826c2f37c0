#include "touch_phases.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"
#include "store/table_file.h"

namespace palpate::report {
namespace {

constexpr double kLeastContact = 0.01, kLeastSpeed = 0.02, kLeastRest_s = 0.02, kLeastShare = 1e-3;

/// Half-open range of ticks.
struct Ticks {
  std::size_t begin = 0, end = 0;
};

/// Returns the ticks around the largest force with contact.
Ticks contact_around_peak(const std::vector<double>& contact_n) {
  const auto peak = std::max_element(contact_n.begin(), contact_n.end());
  if (peak == contact_n.end() || !(*peak > 0.0)) return {};
  const auto at = static_cast<std::size_t>(peak - contact_n.begin());
  Ticks out{at, at + 1};
  while (out.begin > 0 && contact_n[out.begin - 1] > kLeastContact * *peak) --out.begin;
  while (out.end < contact_n.size() && contact_n[out.end] > kLeastContact * *peak) ++out.end;
  return out;
}

/// Returns the longest rest of the handle within a touch; empty if it is too short.
Ticks longest_rest(const TouchMotion& motion, const Ticks& touch) {
  const double fastest = *std::max_element(motion.speed_m_s.begin(), motion.speed_m_s.end());
  Ticks longest;
  for (std::size_t i = touch.begin; i < touch.end;) {
    if (!(motion.speed_m_s[i] < kLeastSpeed * fastest)) {
      ++i;
      continue;
    }
    Ticks rest{i, i};
    while (rest.end < touch.end && motion.speed_m_s[rest.end] < kLeastSpeed * fastest) ++rest.end;
    if (rest.end - rest.begin > longest.end - longest.begin) longest = rest;
    i = rest.end;
  }
  const bool enough = longest.end > longest.begin &&
                      motion.time_s[longest.end - 1] - motion.time_s[longest.begin] >= kLeastRest_s;
  return enough ? longest : Ticks{};
}

}  // namespace

std::vector<Span> touch_phases(const TouchMotion& motion) {
  const Ticks touch = contact_around_peak(motion.contact_n);
  if (touch.end == touch.begin) return {};
  const Ticks rest = longest_rest(motion, touch);
  const double first = motion.time_s.front(), last = motion.time_s.back();
  const auto at = [&](std::size_t tick) { return tick < motion.time_s.size() ? motion.time_s[tick] : last; };
  std::vector<Span> all = {{first, at(touch.begin), "approach"}};
  if (rest.end > rest.begin) {
    all.push_back({at(touch.begin), at(rest.begin), "touch"});
    all.push_back({at(rest.begin), at(rest.end), "hold"});
    all.push_back({at(rest.end), at(touch.end), "release"});
  } else {
    all.push_back({at(touch.begin), at(touch.end), "touch"});
  }
  all.push_back({at(touch.end), last, "free"});
  std::erase_if(all, [&](const Span& span) { return span.to - span.from <= kLeastShare * (last - first); });
  return all;
}

TouchMotion read_touch(const std::filesystem::path& dir) {
  TouchMotion out;
  const std::filesystem::path file = dir / "haptic.h5";
  if (!std::filesystem::exists(file)) return out;
  store::Table ticks;
  try {
    ticks = store::read_table(file.string(), "ticks");
  } catch (const Error&) { return out; }
  const auto column = [&](const std::string& name) {
    const auto found = std::find(ticks.columns.begin(), ticks.columns.end(), name);
    return static_cast<std::size_t>(found - ticks.columns.begin());
  };
  std::vector<std::size_t> force, velocity;
  for (const char* axis : {"x", "y", "z"}) {
    force.push_back(column(fmt::format("contact_force_{}_n", axis)));
    velocity.push_back(column(fmt::format("handle_linear_{}_m_s", axis)));
  }
  const std::size_t time = column("time_s"), none = ticks.columns.size();
  for (const auto* list : {&force, &velocity})
    if (std::find(list->begin(), list->end(), none) != list->end()) return out;
  if (time == none) return out;
  const auto length = [](std::span<const double> row, const std::vector<std::size_t>& at) {
    return std::hypot(row[at[0]], row[at[1]], row[at[2]]);
  };
  for (std::size_t i = 0; i < ticks.rows(); ++i) {
    const std::span<const double> row = ticks.row(i);
    out.time_s.push_back(row[time]);
    out.contact_n.push_back(length(row, force));
    out.speed_m_s.push_back(length(row, velocity));
  }
  return out;
}

}  // namespace palpate::report
