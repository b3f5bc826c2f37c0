#include "loop/replay.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "assemble_parts.h"
#include "core/so3.h"
#include "device/monotone_slope.h"
#include "loop/contact_record.h"
#include "palpate/core/error.h"
#include "palpate/core/workers.h"
#include "palpate/device/registry.h"
#include "palpate/dynamics/path.h"
#include "palpate/scene/hands.h"
#include "single_rate.h"
#include "tick_group.h"

namespace palpate::loop {
namespace {

/// Limits the twists at the ends of a segment of length h [s] so that motion_between() stays between the two
/// poses: in each component of the position, and of the rotation vector from one orientation to the other.
/// The twists of a peer need not be the rates of its poses.
void keep_between(dynamics::RigidMotion& from, dynamics::RigidMotion& to, double h) {
  const Vec6 secant = pose_difference(from.pose, to.pose) / h;
  const Vec3 turn = h * secant.head<3>();
  for (dynamics::RigidMotion* end : {&from, &to})
    end->twist.linear = device::monotone_slope(end->twist.linear, secant.tail<3>());
  from.twist.angular = device::monotone_slope(from.twist.angular, secant.head<3>());
  to.twist.angular = left_jacobian(turn) *
                     device::monotone_slope(left_jacobian_inverse(turn) * to.twist.angular, secant.head<3>());
}

/// Tolerance for equal times of ticks, which may be computed in different ways.
constexpr double kSameTime = 1e-10;

class RecordedHand : public device::Device {
 public:
  explicit RecordedHand(HapticRecord record) : record_(std::make_shared<HapticRecord>(std::move(record))) {
    if (record_->ticks.empty()) fail("replay: the record has no ticks");
  }
  device::DeviceSpecification specification() const override { return {}; }
  std::optional<device::TimeSpan> recorded() const override {
    return device::TimeSpan{record_->start.time, record_->ticks.back().time};
  }
  bool can_be_archived() const override { return true; }
  std::function<device::HandleSample(double)> path() const override {
    return [record = record_](double t) { return at(*record, t); };
  }

 protected:
  device::HandleSample do_sample(double t) override { return at(*record_, t); }

 private:
  static device::HandleSample sample_of(const TickRecord& tick) {
    return {tick.handle, tick.handle_twist, {}, tick.handle_valid, tick.switches};
  }

  static device::HandleSample at(const HapticRecord& record, double t) {
    const auto& ticks = record.ticks;
    const auto after = std::lower_bound(ticks.begin(), ticks.end(), t - kSameTime,
                                        [](const TickRecord& tick, double time) { return tick.time < time; });
    if (after == ticks.end()) return at_rest(ticks.back());
    if (after->time <= t + kSameTime) return sample_of(*after);
    const TickRecord& before = after == ticks.begin() ? record.start : *(after - 1);
    if (t <= before.time + kSameTime) return sample_of(before);
    const double h = after->time - before.time;
    dynamics::RigidMotion from{before.handle, before.handle_twist}, to{after->handle, after->handle_twist};
    keep_between(from, to, h);
    const dynamics::RigidMotion motion = dynamics::motion_between(from, to, h, (t - before.time) / h);
    return {motion.pose, motion.twist, {}, after->handle_valid, before.switches};
  }

  static device::HandleSample at_rest(const TickRecord& tick) {
    return {tick.handle, {}, {}, tick.handle_valid, tick.switches};
  }

  std::shared_ptr<const HapticRecord> record_;
};

/// Returns the hands whose tools meet that hand's tool, including it, in their order.
std::vector<std::size_t> hands_with(const scene::Description& d, std::size_t hand) {
  const std::vector<std::size_t> first = scene::connected_tools(d);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < first.size(); ++i)
    if (first[i] == first.at(hand)) out.push_back(i);
  return out;
}

/// Returns a scene of these tools and the obstacles alone: the contact between them is computed by the ticks,
/// and is not part of the bodies' records.
scene::Description tools_alone(const scene::Description& d, const std::vector<std::size_t>& hands) {
  const std::vector<scene::Hand> all = scene::hands_of(d);
  scene::Description out = d;
  out.bodies.clear();
  out.bones.clear();
  out.hands.clear();
  out.contacts.clear();
  for (const std::size_t i : hands)
    if (i != hands.front()) out.hands.push_back({all[i].name, *all[i].tool, *all[i].device});
  const scene::Hand& first = all[hands.front()];
  out.tool = *first.tool;
  out.device = *first.device;
  const auto stays = [&](const std::string& name) {
    return std::any_of(d.obstacles.begin(), d.obstacles.end(),
                       [&](const auto& o) { return o.name == name; }) ||
           std::any_of(hands.begin(), hands.end(), [&](std::size_t i) { return all[i].name == name; });
  };
  for (ContactSpec contact : d.contacts) {
    if (!stays(contact.first) || !stays(contact.second)) continue;
    for (std::string* side : {&contact.first, &contact.second})
      if (*side == first.name) *side = "tool";
    out.contacts.push_back(contact);
  }
  return out;
}

void refuse_what_cannot_be_retraced(const scene::Description& d, const HapticRecord& record) {
  if (!d.tool || d.exchange.scheme == scene::ExchangeScheme::kMonolithic)
    fail(
        "replay: this run has no exchanges to replay (tool and bodies are one system, or there is no tool); "
        "change "
        "a setting (--set) to simulate it again");
  for (std::size_t i = 0; i < record.ticks.size(); ++i) {
    const double start = i == 0 ? 0.0 : record.ticks[i - 1].time;
    if (std::abs(record.ticks[i].time - start - record.ticks[i].length) > kSameTime)
      fail("replay: ticks are missing before t = {:g} s, because the recorder could not keep up",
           record.ticks[i].time);
  }
}

}  // namespace

void set_clock(HapticRecord& record, const device::RecordingClock& clock) {
  const auto set = [&clock](TickRecord& tick) {
    tick.time = clock(tick.time);
    tick.handle_twist.linear /= clock.scale;
    tick.handle_twist.angular /= clock.scale;
  };
  set(record.start);
  for (TickRecord& tick : record.ticks) set(tick);
}

std::unique_ptr<device::Device> recorded_hand(HapticRecord record) {
  return std::make_unique<RecordedHand>(std::move(record));
}

bool all_paths_known(const World& world) {
  const std::vector<scene::Hand> hands = scene::hands_of(world.description);
  return std::all_of(hands.begin(), hands.end(), [&](const scene::Hand& hand) {
    return static_cast<bool>(device::make_device(*hand.device, world.folder)->path());
  });
}

std::vector<std::unique_ptr<device::Device>> recorded_hands(const std::vector<HapticRecord>& records) {
  std::vector<std::unique_ptr<device::Device>> out;
  for (const HapticRecord& record : records) out.push_back(recorded_hand(record));
  return out;
}

namespace {

/// Hand that repeats its recorded motion.
struct Retraced {
  Retraced(const scene::Description& recorded, const World& world, const HapticRecord& of, ToolInstance& tool)
      : record(of),
        laws(laws_of(recorded, world, tool.spec)),
        haptic_loop(tool, of.models.empty() ? nullptr : &laws) {
    tool.passivity = device::make_passivity_controller(of.passivity, tool.device_spec, tool.spec.tick_s);
  }
  static std::vector<ContactSpec> laws_of(const scene::Description& recorded, const World& world,
                                          const ToolSpec& tool) {
    std::vector<ContactSpec> laws = recorded.contacts;
    for (ContactSpec& law : laws) {
      law.friction_retardation_s = friction_retardation(recorded, law);
      if (law.friction > 0.0 && law.friction_regularisation_m_s == 0.0)
        law.friction_regularisation_m_s = tool_friction_speed(world, tool);
    }
    return laws;
  }
  /// Returns the record in force at a tick.
  const ContactRecord& in_force(std::size_t tick) {
    // Versions count from 1, one per exchange.
    const std::size_t version = record.ticks[tick].record_version;
    if (version > record.exchanges.size())
      fail("replay: the tick at {:g} s used exchange {}, which was not recorded", record.ticks[tick].time,
           version);
    if (version != 0) contact.linear = record.exchanges[version - 1];
    if (version != 0 && !record.models.empty()) contact.touch = record.models[version - 1];
    return contact;
  }
  const HapticRecord& record;
  const std::vector<ContactSpec> laws;
  HapticLoop haptic_loop;
  ContactRecord contact{};
};

/// Tolerance for equal times, relative to a period.
constexpr double kSamePeriod = 1e-6;

/// Keeps the ticks of one hand.
class TicksOfHand : public Observer {
 public:
  explicit TicksOfHand(std::size_t hand) : hand_(hand) {}
  void tick_of(std::size_t hand, const TickRecord& tick) override {
    if (hand == hand_) all.push_back(tick);
  }
  std::vector<TickRecord> all;

 private:
  std::size_t hand_;
};

/// Simulates tools and bodies again under the recorded hands, with steps from tick to tick.
std::vector<TickRecord> retrace_single_rate(const scene::Description& description,
                                            const std::vector<HapticRecord>& records, std::size_t hand) {
  for (const HapticRecord& record : records) refuse_what_cannot_be_retraced(description, record);
  const std::vector<TickRecord>& ticks = records.at(hand).ticks;
  if (ticks.empty()) fail("replay: the record has no ticks");
  const auto world = assemble(description, recorded_hands(records));
  const workers::Count threads(description.integrator.threads);
  TicksOfHand out(hand);
  RunOptions options;
  options.duration_s = ticks.back().time;
  options.passivity = records[hand].passivity;
  options.observers = {&out};
  RunResult result;
  BodyLoop bodies(*world, options, result);
  std::deque<HapticLoop> loops;
  std::vector<HapticLoop*> of_hands;
  for (ToolInstance& tool : world->tools) of_hands.push_back(&loops.emplace_back(description, tool));
  SingleRate single(*world, bodies, result, of_hands);
  for (HapticLoop& loop : loops) loop.start(0.0);
  bodies.start();
  single.start();
  const double period = bodies.period();
  for (const TickRecord& tick : ticks) {
    const double start = world->state.time();
    single.query_if_due(start, period * (std::floor(start / period + kSamePeriod) + 1.0));
    single.mark(tick.ramps_in, tick.left_out);
    single.tick(start, tick.time);
    if (!result.status.ok()) fail("replay: {}", result.status.message);
  }
  return std::move(out.all);
}

}  // namespace

std::vector<TickRecord> retrace(const scene::Description& description,
                                const std::vector<HapticRecord>& records, std::size_t hand) {
  if (description.exchange.scheme == scene::ExchangeScheme::kSingleRate)
    return retrace_single_rate(description, records, hand);
  const std::vector<std::size_t> hands = hands_with(description, hand);
  for (const std::size_t i : hands) {
    refuse_what_cannot_be_retraced(description, records.at(i));
    if (records[i].ticks.size() != records[hand].ticks.size())
      fail(
          "replay: {} and {} ticks were recorded for two hands whose tools can touch; their numbers must be "
          "equal",
          records[hand].ticks.size(), records[i].ticks.size());
  }
  const scene::Description alone = tools_alone(description, hands);
  std::vector<std::unique_ptr<device::Device>> devices;
  for (const std::size_t i : hands) devices.push_back(recorded_hand(records[i]));
  const auto world = assemble(alone, std::move(devices));
  std::deque<Retraced> retraced;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    retraced.emplace_back(description, *world, records[hands[i]], world->tools[i]);
    retraced.back().haptic_loop.start(0.0);
  }
  std::vector<TickGroup> group = TickGroup::all(retraced);
  PALPATE_CHECK(group.size() == 1, "{} groups of hands whose tools can touch, expected 1", group.size());
  std::vector<TickRecord> out;
  for (std::size_t n = 0; n < records[hand].ticks.size(); ++n) {
    const TickRecord& tick = records[hand].ticks[n];
    group[0].find_contact(tick.time, tick.length,
                          [&](std::size_t i) -> const ContactRecord& { return retraced[i].in_force(n); });
    for (std::size_t i = 0; i < hands.size(); ++i) {
      TickRecord again;
      if (tick.ramps_in) retraced[i].haptic_loop.ramp_in();
      const dynamics::StepResult status =
          retraced[i].haptic_loop.tick(tick.time, tick.length, group[0].contact(i), again);
      if (!status.ok()) fail("replay: {}", status.message);
      again.left_out = tick.left_out;
      if (hands[i] == hand) out.push_back(again);
    }
  }
  return out;
}

}  // namespace palpate::loop
