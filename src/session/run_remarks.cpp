#include "session/run_remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "loop/describe_fallbacks.h"
#include "loop/penetration.h"
#include "loop/summary.h"
#include "palpate/scene/hands.h"
#include "session/clock_figures.h"

namespace palpate::session {
namespace {

using Remarks = std::vector<std::string>;

std::string hand_label(const loop::World& world, std::size_t hand) {
  return hand == 0 ? "the hand" : fmt::format("hand \"{}\"", world.description.hands[hand - 1].name);
}

/// Returns the number of ticks without a pose, and of all ticks.
std::pair<long, long> ticks_without_pose(const loop::RunResult& result, std::size_t hand) {
  if (hand == 0) return {result.ticks_without_pose, result.ticks};
  const loop::HandResult& more = result.more_hands[hand - 1];
  return {more.ticks_without_pose, more.ticks};
}

/// Adds the ticks for which a device had no pose.
void add_gaps(const loop::World& world, const loop::RunResult& result, Remarks& out) {
  for (std::size_t hand = 0; hand <= result.more_hands.size(); ++hand) {
    const auto [without, ticks] = ticks_without_pose(result, hand);
    if (without == 0) continue;
    out.push_back(
        fmt::format("device of {}: no force in {} of {} ticks, because its last pose was older than 20 ms",
                    hand_label(world, hand), without, ticks));
  }
}

/// Adds the counters of a device, with "packets_stale" printed as "3 packets stale": the first one, of what
/// arrived, and those of events that occurred.
void add_device_counts(const loop::World& world, std::size_t hand, Remarks& out) {
  std::string text;
  for (const auto& [name, count] : loop::tallies_of(world, hand)) {
    if (!text.empty() && count == 0) continue;
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, words);
  }
  if (!text.empty()) out.push_back(fmt::format("device of {}: {}", hand_label(world, hand), text));
}

void add_ticks(const loop::RunResult& result, Remarks& out) {
  if (result.rejected_ticks > 0)
    out.push_back(fmt::format(
        "in {} ticks the wrench was not finite or time did not advance; the force was ramped to zero",
        result.rejected_ticks));
  if (result.outside_ticks > 0)
    out.push_back(
        fmt::format("in {} ticks the handle was outside the workspace of the device, where forces fade to "
                    "zero; move the workspace by device.workspace_center_m",
                    result.outside_ticks));
}

void add_placements(const loop::World& world, Remarks& out) {
  for (const loop::ToolPlacement& p : world.placements)
    out.push_back(
        fmt::format("\"{}\" placed: moved by {:.4g} mm to ({:.5g}, {:.5g}, {:.5g}) m, where it touches "
                    "\"{}\" at ({:.5g}, "
                    "{:.5g}, {:.5g}) m; its keyframes moved with it",
                    p.tool, 1e3 * p.moved_m, p.position_m.x(), p.position_m.y(), p.position_m.z(), p.touched,
                    p.touch_m.x(), p.touch_m.y(), p.touch_m.z()));
}

void add_penetrations(const loop::World& world, Remarks& out) {
  const std::vector<loop::PenetrationReport> penetrations = loop::penetration_reports(world);
  std::string text;
  for (const loop::PenetrationReport& o : penetrations)
    if (o.deepest_m > 0.0)
      text += fmt::format("{}{} {:.3g} mm", text.empty() ? "" : ", ", o.pair, 1e3 * o.deepest_m);
  if (!text.empty()) out.push_back(fmt::format("deepest overlap: {}", text));
}

void add_quadrature(const loop::World& world, Remarks& out) {
  std::string text;
  for (const loop::PenetrationReport& o : loop::penetration_reports(world)) {
    if (o.quadrature_error == 0.0) continue;
    text +=
        fmt::format("{}{} {:.2g} % of the largest force (bound; largest share of one point {:.2g} %)",
                    text.empty() ? "" : ", ", o.pair, 100.0 * o.quadrature_error, 100.0 * o.largest_share);
  }
  if (!text.empty()) out.push_back(fmt::format("contact quadrature: {}", text));
}

/// Adds the error that exchange.linearisation_error bounds.
void add_reduction_errors(const loop::World& world, Remarks& out) {
  for (const loop::AnswerError& e : loop::answer_errors_of(world)) {
    if (e.factored == e.exchanges) {
      out.push_back(fmt::format("{}: reduced response of the bodies exact (factored) in all {} exchanges",
                                e.tool, e.exchanges));
      continue;
    }
    std::string text = fmt::format(
        "{}: reduced response of the bodies: error at most {:.2g} % (bound) in {} of {} exchanges", e.tool,
        100.0 * (e.beyond > 0 ? e.requested : e.largest), e.exchanges - e.beyond, e.exchanges);
    if (e.beyond > 0)  // a bound above 100 % carries no information
      text += fmt::format("; in {} the iteration stopped at its limit with bounds up to {:.2g} %{}", e.beyond,
                          100.0 * e.largest, e.largest > 1.0 ? ", which are not informative" : "");
    if (e.factored > 0) text += fmt::format("; exact (factored) in {}", e.factored);
    out.push_back(text);
  }
}

}  // namespace

std::string port_remark(const loop::PortEnergy& port) {
  std::string out = fmt::format("energy at the device port: minimum {:.3g} J, at the end {:.3g} J",
                                port.least, port.energy);
  if (port.controller_ticks == 0) return out;
  const double kept = port.controller_dissipated;
  out += fmt::format("; the passivity controller reduced the force in {} tick{}, which ",
                     port.controller_ticks, port.controller_ticks == 1 ? "" : "s");
  out += kept < 0.0 ? fmt::format("spared the hand {:.3g} J of work", -kept)
                    : fmt::format("kept {:.3g} J from the hand", kept);
  if (port.work > 0.0)
    out += fmt::format(" ({:.2g} % of the motors' work)", 100.0 * std::abs(kept) / port.work);
  return out;
}

void check_poses_arrived(const loop::World& world, const loop::RunResult& result, MissingOutputs& missing) {
  if (result.stopped || result.ticks == 0) return;
  for (std::size_t hand = 0; hand <= result.more_hands.size(); ++hand) {
    const auto [without, ticks] = ticks_without_pose(result, hand);
    if (without == ticks)
      missing.add(fmt::format("force on {}", hand_label(world, hand)),
                  fmt::format("its device sent no pose in {} ticks: start it before the run, and check its "
                              "connection",
                              ticks));
    else if (2 * without > ticks)
      missing.add(
          fmt::format("force on {}", hand_label(world, hand)),
          fmt::format(
              "its device had sent no pose for 20 ms or more in {} of {} ticks: keep it sending until "
              "the end, or shorten the run",
              without, ticks));
  }
}

std::vector<std::string> run_remarks(const loop::World& world, const loop::RunResult& result) {
  Remarks out;
  add_placements(world, out);
  if (world.stepper)
    if (const std::string fallbacks = loop::describe_fallbacks(result.counters); !fallbacks.empty())
      out.push_back(fmt::format("fallbacks of {}: {}", world.stepper->name(), fallbacks));
  if (result.ticks > 0)
    for (std::size_t i = 0; i <= result.more_hands.size(); ++i) add_device_counts(world, i, out);
  add_gaps(world, result, out);
  add_ticks(result, out);
  if (result.buzz_n)
    out.push_back(fmt::format("buzz: {:.3g} N RMS of the force on the hand above 30 Hz", *result.buzz_n));
  add_penetrations(world, out);
  add_quadrature(world, out);
  add_reduction_errors(world, out);
  if (result.port) out.push_back(port_remark(*result.port));
  if (result.real_time)
    for (std::string& line : clock_remarks(result, world.description.exchange.linearisation))
      out.push_back(std::move(line));
  return out;
}

}  // namespace palpate::session
