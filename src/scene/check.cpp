#include "scene/check.h"

#include <cmath>
#include <set>

#include "palpate/core/named_enum.h"
#include "palpate/scene/hands.h"
#include "scene/reader.h"

namespace palpate::scene {
namespace {

std::string at(const char* list, std::size_t i, const std::string& rest = "") {
  return fmt::format("{}[{}]{}{}", list, i, rest.empty() || rest[0] == '[' ? "" : ".", rest);
}

/// Checks a name: it becomes part of file names, column headers and keys of reports.
void check_name(const Document& doc, const std::string& where, const std::string& name) {
  for (const char letter : name)
    if (const auto c = static_cast<unsigned char>(letter);
        c < 0x20 || c == 0x7f || c == '/' || c == '\\' || c == '"')
      refuse(location(doc, where), "",
             fmt::format("the name \"{}\" must not contain slashes, quotes or control characters", name));
}

void check_names(const Document& doc, const Description& d) {
  check_name(doc, "scene.name", d.name);
  std::set<std::string> seen;
  const auto check_one = [&](const char* kind, std::size_t i, const std::string& name) {
    const std::string key = at(kind, i, "name");
    const std::string where = fmt::format("{} \"{}\"", kind, name);
    check_name(doc, key, name);
    if (name == "tool")
      refuse(location(doc, key), where, "name \"tool\" is reserved for [tool]; choose another");
    if (!seen.insert(name).second)
      refuse(
          location(doc, key), where,
          fmt::format("name \"{}\" is already taken; bodies, bones, obstacles and hands need distinct names",
                      name));
  };
  for (std::size_t i = 0; i < d.bodies.size(); ++i) check_one("body", i, d.bodies[i].name);
  for (std::size_t i = 0; i < d.bones.size(); ++i) check_one("bone", i, d.bones[i].name);
  for (std::size_t i = 0; i < d.obstacles.size(); ++i) check_one("obstacle", i, d.obstacles[i].name);
  for (std::size_t i = 0; i < d.hands.size(); ++i) check_one("hand", i, d.hands[i].name);
}

void check_loads(const Document& doc, const Description& d) {
  for (std::size_t i = 0; i < d.bodies.size(); ++i)
    for (std::size_t j = 0; j < d.bodies[i].loads.size(); ++j) {
      const LoadSpec& load = d.bodies[i].loads[j];
      check_box(doc, at("body", i, at("load", j)), fmt::format("body \"{}\": load[{}]", d.bodies[i].name, j),
                load.box_min_m, load.box_max_m);
    }
}

/// Returns the label of a hand's tool or device in messages: "tool", `hand "left": tool`.
std::string label_of(const Hand& hand, const std::string& what) {
  return hand.name == "tool" ? what : fmt::format("hand \"{}\": {}", hand.name, what);
}

void check_hand(const Document& doc, const Hand& hand) {
  if (hand.device)
    check_keyframes(doc, hand.device_key + ".keyframe", label_of(hand, "device"), hand.device->keyframes);
  const Vec3& inertia = hand.tool->inertia_kg_m2;
  const std::string key = hand.tool_key + ".inertia_kg_m2", where = label_of(hand, "tool");
  if (hand.tool->shape == ToolShape::kMesh && inertia.isZero(0.0))
    refuse(location(doc, key), where, "inertia_kg_m2 is missing: shape = \"mesh\" has no default inertia");
  const double largest = inertia.maxCoeff();
  if (!inertia.isZero(0.0) && (inertia.minCoeff() <= 0.0 || 2.0 * largest > inertia.sum() * (1.0 + 1e-9)))
    refuse(location(doc, key), where,
           fmt::format("inertia_kg_m2 = [{}, {}, {}] is not the inertia of a rigid body: all must be "
                       "positive and none larger than the sum of the other two",
                       inertia[0], inertia[1], inertia[2]));
}

void check_tool(const Document& doc, const Description& d) {
  if (d.tool && !d.device)
    refuse(location(doc, "tool"), "tool", "a tool needs a device: add [device] with [[device.keyframe]]");
  if (d.device && !d.tool)
    refuse(location(doc, "device"), "device",
           "a device needs something to move: add [tool], or remove [device]");
  if (!d.hands.empty() && !d.tool)
    refuse(location(doc, "hand[0]"), fmt::format("hand \"{}\"", d.hands[0].name),
           "[[hand]] adds further hands to that of [tool] and [device], which are missing; add them");
  for (const Hand& hand : hands_of(d)) check_hand(doc, hand);
}

/// Whether `whole` is a positive integer multiple of `part`, to rounding of decimal input.
bool is_multiple(double whole, double part) {
  const double ratio = whole / part, n = std::round(ratio);
  return n >= 1.0 && std::abs(ratio - n) <= 1e-9 * n;
}

void check_period(const Document& doc, const std::string& key, const std::string& where, double period,
                  double tick, const std::string& tick_key) {
  const double most = 1e6;
  const std::string_view name = key.substr(key.find_last_of('.') + 1) == "contact_refresh_s"
                                    ? "contact_refresh_s"
                                : where == "exchange" ? "exchange_period_s"
                                                      : "exchange_periods_s";
  if (period / tick > most)
    refuse(
        location(doc, tick_key), where,
        fmt::format("tick_s = {} of the tool gives {:.3g} ticks per {} of {} s, at most {:g} are possible; "
                    "haptic devices use 0.001",
                    tick, period / tick, name == "contact_refresh_s" ? "contact refresh" : "exchange period",
                    period, most));
  if (is_multiple(period, tick)) return;
  const double below = std::floor(period / tick), n = std::max(1.0, below);
  refuse(location(doc, key), where,
         fmt::format("{} = {} must be a multiple of the tool's tick of {} s; use {:.9g} or {:.9g}", name,
                     period, tick, n * tick, (n + 1.0) * tick));
}

/// Checks times of material changes.  Between exchanges the tool uses a model of the body taken earlier;
/// therefore a body touched by a tool changes at the start of an exchange period.
void check_changes(const Document& doc, const Description& d) {
  for (std::size_t i = 0; i < d.bodies.size(); ++i) {
    const std::string where = fmt::format("body \"{}\": change", d.bodies[i].name);
    for (std::size_t j = 0; j < d.bodies[i].changes.size(); ++j) {
      const double time = d.bodies[i].changes[j].time_s, period = d.exchange.has_tools_in_state()
                                                                      ? d.exchange.contact_refresh_s
                                                                      : d.exchange.exchange_period_s;
      const std::string key = at("body", i, at("change", j, "time_s"));
      if (j > 0 && time < d.bodies[i].changes[j - 1].time_s)
        refuse(location(doc, key), where,
               fmt::format("time_s = {} must be greater than the previous one ({})", time,
                           d.bodies[i].changes[j - 1].time_s));
      for (std::size_t k = 0; k < j; ++k)
        if (d.bodies[i].changes[k].time_s == time &&
            d.bodies[i].changes[k].region == d.bodies[i].changes[j].region)
          refuse(location(doc, key), where,
                 fmt::format(
                     "time_s = {} must be greater than the previous one ({}): both change the same elements",
                     time, time));
      if (time >= d.duration_s)
        refuse(
            location(doc, key), where,
            fmt::format("time_s = {} must be less than the duration of the run, {} s", time, d.duration_s));
      if (d.tool && !is_multiple(time, period))
        refuse(location(doc, key), where,
               fmt::format("time_s = {} must be a whole number of {} of {} s: between them the tool uses a "
                           "model of the body made before the change",
                           time, d.exchange.has_tools_in_state() ? "contact refreshes" : "exchange periods",
                           period));
    }
  }
}

/// Checks that the run is not shorter than the period: otherwise no exchange would take place.
void check_length(const Document& doc, const std::string& key, const std::string& where, double period,
                  double duration) {
  if (period <= duration * (1.0 + 1e-9)) return;
  refuse(location(doc, key), where,
         fmt::format(
             "{} = {} is longer than the run of {} s; use at most {}, usually a tenth of the run or less",
             where == "exchange" ? "exchange_period_s" : "exchange_periods_s", period, duration, duration));
}

void check_periods(const Document& doc, const Description& d) {
  const CosimulationSpec& c = d.exchange;
  const bool own = given(doc, "exchange.exchange_period_s");
  const double compared = d.compare.duration_s > 0.0 ? d.compare.duration_s : d.duration_s;
  if (c.scheme == ExchangeScheme::kSingleRate || c.scheme == ExchangeScheme::kAuto) {
    const bool refresh = given(doc, "exchange.contact_refresh_s");
    for (const Hand& hand : hands_of(d)) {
      const std::string tick = hand.tool_key + ".tick_s";
      check_period(doc,
                   refresh ? "exchange.contact_refresh_s"
                   : own   ? "exchange.exchange_period_s"
                           : tick,
                   "exchange", c.contact_refresh_s, hand.tool->tick_s, tick);
    }
  }
  if (!c.has_tools_in_state()) {
    for (const Hand& hand : hands_of(d)) {
      const std::string tick = hand.tool_key + ".tick_s";
      check_period(doc, own ? "exchange.exchange_period_s" : tick, "exchange", c.exchange_period_s,
                   hand.tool->tick_s, tick);
    }
    check_length(doc, own ? "exchange.exchange_period_s" : "scene.duration_s", "exchange",
                 c.exchange_period_s, d.duration_s);
  }
  for (std::size_t i = 0; i < d.compare.exchange_periods_s.size(); ++i) {
    const std::string key = fmt::format("compare.exchange_periods_s[{}]", i);
    check_length(doc, key, "compare", d.compare.exchange_periods_s[i], compared);
  }
}

/// Limit of the latency.  Several exchanges may be under way at a time; beyond this the force lags far behind
/// the hand, and each pending exchange takes memory.
constexpr double kLongestLatency = 10.0;  // periods

void check_latency(const Document& doc, const Description& d) {
  const CosimulationSpec& c = d.exchange;
  const std::string key = location(doc, "exchange.latency_ticks");
  if (!d.tool || c.has_tools_in_state())
    refuse(key, "exchange",
           "latency_ticks applies only to a tool that steps separately: scheme = \"partitioned\" and [tool]");
  if (const double longest = kLongestLatency * c.exchange_period_s / d.tool->tick_s;
      static_cast<double>(c.latency_ticks) > longest * (1.0 + 1e-9))
    refuse(key, "exchange",
           fmt::format("latency_ticks = {} is longer than {:g} exchange periods, {:.9g} ticks",
                       c.latency_ticks, kLongestLatency, longest));
}

void check_exchange(const Document& doc, Description& d) {
  CosimulationSpec& c = d.exchange;
  if (!given(doc, "exchange.contact_refresh_s")) c.contact_refresh_s = c.exchange_period_s;
  if (d.tool)
    check_periods(doc, d);
  else if (c.scheme != ExchangeScheme::kPartitioned)
    refuse(location(doc, "exchange.scheme"), "exchange",
           fmt::format("scheme = \"{}\" needs a tool: there is nothing to couple without one",
                       name_of(c.scheme)));
  else if (!d.compare.exchange_periods_s.empty())
    refuse(location(doc, "compare.exchange_periods_s"), "compare",
           "exchange_periods_s needs a tool: nothing is exchanged without one");
  if (c.latency_ticks > 0) check_latency(doc, d);
  if (c.tunnelling == TunnellingPolicy::kSubstep && !(c.shortest_refresh_s < c.contact_refresh_s))
    refuse(location(doc, "exchange.shortest_refresh_s"), "exchange",
           fmt::format("shortest_refresh_s = {} must be less than contact_refresh_s = {}: otherwise "
                       "\"substep\" has no effect",
                       c.shortest_refresh_s, c.contact_refresh_s));
  if (c.has_tools_in_state()) return;  // Contact has an independent refresh period.
  if (!is_multiple(c.exchange_period_s, c.contact_refresh_s))
    refuse(location(doc, "exchange.contact_refresh_s"), "exchange",
           fmt::format("contact_refresh_s = {} must divide exchange_period_s = {} evenly; use {:.9g}",
                       c.contact_refresh_s, c.exchange_period_s,
                       c.exchange_period_s /
                           std::max(1.0, std::ceil(c.exchange_period_s / c.contact_refresh_s - 1e-9))));
}

}  // namespace

void check_keyframes(const Document& doc, const std::string& key, const std::string& where,
                     const std::vector<KeyframeSpec>& frames) {
  for (std::size_t i = 1; i < frames.size(); ++i)
    if (frames[i].time_s <= frames[i - 1].time_s)
      refuse(
          location(doc, fmt::format("{}[{}].time_s", key, i)), fmt::format("{}: keyframe[{}]", where, i),
          fmt::format("time_s = {} must come after {}, the previous keyframe; put keyframes in order of time",
                      frames[i].time_s, frames[i - 1].time_s));
}

void check_box(const Document& doc, const std::string& key, const std::string& where, const Vec3& low,
               const Vec3& high) {
  for (int axis = 0; axis < 3; ++axis)
    if (low[axis] > high[axis])
      refuse(location(doc, key + ".box_max_m"), where,
             fmt::format("box_max_m = {} must not be below box_min_m = {} along {}", high[axis], low[axis],
                         "xyz"[axis]));
}

void check(const Document& doc, Description& d) {
  if (d.bodies.empty() && !d.tool)
    refuse(location(doc, "scene"), "",
           "there is nothing to simulate: add a [[body]], or a [tool] with a [device]");
  check_names(doc, d);
  check_meshes(doc, d);
  check_regions(doc, d);
  check_skeletons(doc, d);
  check_loads(doc, d);
  check_bones(doc, d);
  check_attachments(doc, d);
  check_tool(doc, d);
  check_contacts(doc, d);
  check_exchange(doc, d);
  check_changes(doc, d);
}

}  // namespace palpate::scene
