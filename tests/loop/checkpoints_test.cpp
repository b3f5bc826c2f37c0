// A run resumed from a checkpoint is bitwise equal to an uninterrupted one; a checkpoint contains everything
// that the run needs, and nothing else.
#include "loop/checkpoints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <optional>
#include <set>

#include "checkpoint_scenes.h"
#include "loop/contact_record.h"
#include "loop/summary.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"

namespace {

using namespace palpate;
using namespace palpate::checkpoint_scenes;

/// Everything that a run reports to an observer: each tick, record and period, in order.
class Log : public loop::Observer {
 public:
  explicit Log(bool energy) : energy_(energy) {}
  void tick_of(std::size_t hand, const loop::TickRecord& tick) override {
    list({static_cast<double>(hand), tick.time, static_cast<double>(tick.switches),
          static_cast<double>(tick.record_version)});
    add(tick.tool);
    add(tick.handle);
    add(tick.handle_twist);
    add(tick.contact);
    add(tick.requested);
    add(tick.device);
  }
  void exchanged_of(std::size_t, const loop::ContactRecord& record) override {
    range(record.linear.F0);
    range(record.linear.J);
  }
  void period(loop::World& world, double t) override {
    list({t});
    range(world.state.q());
    range(world.state.u());
  }
  bool wants_energy() const override { return energy_; }
  void energy(const loop::EnergyBalance& balance) override {
    loop::visit_energies([&](const char*, double value) { list({value}); }, balance);
  }
  void archive(Archive& a) override { a("all", all); }
  std::vector<double> all;

 private:
  void range(const auto& numbers) { all.insert(all.end(), numbers.begin(), numbers.end()); }
  void list(std::initializer_list<double> numbers) { range(numbers); }
  void add(const Vec3& v) { range(v); }
  void add(const Pose& p) { range(p.translation), range(p.rotation.coeffs()); }
  void add(const Twist& t) { add(t.angular), add(t.linear); }
  void add(const Wrench& w) { add(w.moment), add(w.force); }
  bool energy_;
};

/// Final state and log of a run.
struct Outcome {
  VecX q, u;
  std::vector<double> log;
  std::map<std::string, double> counts;
  std::vector<Archive> checkpoints;
};

std::vector<double> feel_of(const loop::RunResult& result) {
  std::vector<double> out = {result.buzz_n.value_or(-1.0), static_cast<double>(result.ticks_without_pose)};
  if (result.port)
    out.insert(out.end(),
               {result.port->energy, result.port->least, result.port->work,
                result.port->controller_dissipated, static_cast<double>(result.port->controller_ticks)});
  for (const loop::HandResult& hand : result.more_hands)
    out.insert(out.end(), {static_cast<double>(hand.ticks), static_cast<double>(hand.limited_ticks),
                           static_cast<double>(hand.ticks_without_pose), hand.buzz_n.value_or(-1.0)});
  return out;
}

Outcome outcome_of(const loop::World& world, const loop::RunResult& result, const Log& log) {
  EXPECT_TRUE(result.status.ok()) << result.status.message;
  Outcome out{world.state.q(), world.state.u(), log.all, {}, {}};
  loop::visit_counters(
      [&]<class T>(const char* name, const T& value) {
        if constexpr (std::is_same_v<T, long>) out.counts[name] = static_cast<double>(value);
      },
      result);
  const std::vector<double> feel = feel_of(result);
  for (std::size_t i = 0; i < feel.size(); ++i) out.counts["feel " + std::to_string(i)] = feel[i];
  if (world.contact) {
    const contact::ContactStatistics& all = world.contact->statistics();
    out.counts["largest jump"] = all.largest_jump.force;
    out.counts["largest moment jump"] = all.largest_jump.moment;
    out.counts["largest after"] = all.largest_resultant.force;
    out.counts["largest moment after"] = all.largest_resultant.moment;
    out.counts["friction lag"] = all.largest_friction_lag;
    out.counts["friction"] = all.largest_lagged_friction;
    const contact::GraspCounts& grasps = all.grasps;
    out.counts["grasps"] = static_cast<double>(grasps.closed);
    out.counts["empty grasps"] = static_cast<double>(grasps.empty);
    out.counts["grasped points"] = grasps.points;
    out.counts["grasped area"] = grasps.area;
    out.counts["largest grasped area"] = grasps.largest_area;
    for (const contact::PairReport& pair : world.contact->pairs()) {
      out.counts["tunnelled"] += static_cast<double>(pair.tunnelled);
      out.counts["fast"] += static_cast<double>(pair.fast_regions);
      out.counts["kept"] += static_cast<double>(pair.normals_kept);
      out.counts["deepest"] += pair.deepest;
      if (pair.stages) out.counts["images"] += static_cast<double>(pair.stages->images);
      if (pair.stages) out.counts["pairs"] += static_cast<double>(pair.stages->pairs);
      if (pair.sum_error) {
        out.counts["quadrature"] += pair.sum_error->largest();
        out.counts["largest share"] += pair.sum_error->largest_share();
      }
    }
  }
  for (const loop::AnswerError& e : loop::answer_errors_of(world)) {
    out.counts["answers"] += static_cast<double>(e.exchanges);
    out.counts["factored answers"] += static_cast<double>(e.factored);
    out.counts["answers beyond"] += static_cast<double>(e.beyond);
    out.counts["largest answer error"] += e.largest;
    out.counts["mean answer error"] += e.mean;
  }
  return out;
}

loop::RunOptions options_of(const Case& c, Log& log) {
  loop::RunOptions options;
  options.observers = {&log};
  options.passivity = c.passivity;
  return options;
}

Outcome plain(const Case& c) {
  Log log(c.energy);
  auto world = loop::assemble(c.scene);
  const loop::RunResult result = loop::run(*world, options_of(c, log));
  return outcome_of(*world, result, log);
}

/// @param from  a checkpoint of the run; null: from the start
Outcome with_checkpoints(const Case& c, const Archive::Values* values = nullptr) {
  Log log(c.energy);
  std::vector<Archive> kept;
  loop::CheckpointPlan plan;
  plan.every_s = c.every_s;
  plan.assemble = [&] { return loop::assemble(c.scene); };
  plan.keep = [&](double, const Archive& archive) { kept.push_back(archive); };
  auto world = loop::assemble(c.scene);
  std::optional<loop::Resumed> from;
  if (values) from.emplace(Archive(*values, "one/checkpoint.h5"));
  loop::CheckpointCost cost;
  const loop::RunResult result =
      loop::run_with_checkpoints(world, options_of(c, log), plan, cost, from ? &*from : nullptr);
  Outcome out = outcome_of(*world, result, log);
  out.checkpoints = std::move(kept);
  out.counts["checkpoints"] = static_cast<double>(cost.written);
  return out;
}

bool same_bits(const double* a, const double* b, std::size_t n) {
  return std::memcmp(a, b, n * sizeof *a) == 0;
}

/// Describes what differs bitwise; empty if nothing does.
std::string difference(const Outcome& a, const Outcome& b) {
  if (a.q.size() != b.q.size() || !same_bits(a.q.data(), b.q.data(), static_cast<std::size_t>(a.q.size())))
    return "q";
  if (!same_bits(a.u.data(), b.u.data(), static_cast<std::size_t>(a.u.size()))) return "u";
  if (a.log.size() != b.log.size() || !same_bits(a.log.data(), b.log.data(), a.log.size())) return "log";
  for (const auto& [name, count] : a.counts)
    if (const auto other = b.counts.find(name);
        other == b.counts.end() || !same_bits(&count, &other->second, 1))
      return name;
  return {};
}

class Checkpoints : public testing::TestWithParam<std::string> {
 protected:
  Case scene() const { return find_case(GetParam()); }
};

TEST_P(Checkpoints, ARunThatGoesOnIsTheOneThatNeverStopped) {
  const Case c = scene();
  const Outcome whole = with_checkpoints(c);
  ASSERT_GE(whole.checkpoints.size(), 2u);
  for (std::size_t i = 0; i < whole.checkpoints.size(); ++i) {
    EXPECT_EQ(difference(with_checkpoints(c, &whole.checkpoints[i].values()), whole), "")
        << "from checkpoint " << i;
  }
}

// Where a step does not depend on the previous one, and matrices are factored, a restart loses nothing: any
// state missing from the checkpoints would show here.
TEST_P(Checkpoints, ForgetNothing) {
  const Case c = scene();
  const Outcome without = plain(c), with = with_checkpoints(c);
  ASSERT_EQ(without.log.size(), with.log.size());
  double largest = 0.0, off = 0.0;
  for (std::size_t i = 0; i < with.log.size(); ++i) {
    largest = std::max(largest, std::abs(without.log[i]));
    off = std::max(off, std::abs(with.log[i] - without.log[i]) / std::max(c.scale, std::abs(without.log[i])));
  }
  EXPECT_GT(largest, 0.0);
  EXPECT_LE(off, c.restart_error);
  for (const auto& [name, count] : without.counts)
    if (name.starts_with("feel")) {
      EXPECT_NEAR(with.counts.at(name), count, 1e-6 * std::abs(count) + 1e-12) << name;
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Checkpoints, testing::ValuesIn(case_names()),
                         [](const auto& one) { return one.param; });

/// Every dynamic integrator, on a falling body.
TEST(CheckpointsOfIntegrators, GoOnBitForBit) {
  for (const auto& method : integrate::stepper_registry()) {
    SCOPED_TRACE(method.name);
    const Case c = falling_body(method.name);
    const Outcome whole = with_checkpoints(c);
    ASSERT_GE(whole.checkpoints.size(), 2u);
    EXPECT_EQ(difference(with_checkpoints(c, &whole.checkpoints[1].values()), whole), "");
    const Outcome without = plain(c);
    EXPECT_LT((without.q - whole.q).norm(), 2e-3 * (without.q - loop::assemble(c.scene)->state.q()).norm());
  }
}

/// Returns whether a value only states how long something took, or is a reference from which another value is
/// counted.
bool is_time_of_day(const std::string& name) {
  for (const char* end :
       {"loop_cpu_s", "loop_wall_s", "contact_query_s", "linearise_s", "tool_ticks_s", "force_s", "tangent_s",
        "symbolic_s", "factor_s", "solve_s", "keep_s", "assemble_s", "query_seconds"})
    if (name.ends_with(end)) return true;
  bool is_time = name.starts_with("process.") || name == "bodies.counts.simulated_s";
  const contact::QueryStages stages;
  contact::visit_counters(
      [&](const std::string& stage, auto) { is_time |= stage.ends_with("_s") && name.ends_with(stage); },
      stages);
  return is_time;
}

/// Replaces a value by another one of its kind; false if there is no other that a run could have.
bool change(Archive::Value& value) {
  if (auto* numbers = std::get_if<std::vector<double>>(&value)) {
    for (double& number : *numbers) number -= 0.1 * std::abs(number) + 1e-7;
    return !numbers->empty();
  }
  if (auto* integers = std::get_if<std::vector<std::int64_t>>(&value)) {
    for (std::int64_t& integer : *integers) integer = integer == 0 ? 1 : integer - 1;
    return !integers->empty();
  }
  return false;
}

// Without rigid tools there are fewer scenes, and some values affect none of them.
#ifdef PALPATE_HAS_TOOL
constexpr bool kAllScenes = true;
#else
constexpr bool kAllScenes = false;
#endif

/// Values that affect no output of these runs, by prefixes of their names.
const std::vector<std::string> kShownNowhere = {
    // sums and samples that the next period or tick recomputes before they are used
    "bodies.energy.contact_j",
    "bodies.energy.coupling",
    "bodies.energy.dissipated_",
    "bodies.energy.elastic_j",
    "bodies.energy.kinetic",
    "bodies.energy.quadrature",
    "bodies.energy.time",
    "bodies.energy.unaccounted",
    "bodies.energy.work_of_hand_j",
    "bodies.energy.work_of_supports_j",
    "bodies.contact.grasped_",
    "bodies.counts.",
    "bodies.hand..handle_now.",
    "hand..ticks.handle.acceleration",
    "bodies.hand..passivity.observer.tick",
    // reported once, or read by observers other than a run's
    "bodies.contact.pair..warned",
    "bodies.felt..buzz.largest",
    "bodies.hand..device.last.",
    "bodies.hand..device.open",
    "bodies.hand..device.time",
    "bodies.hand..limiter.rejected",
    "hand..ticks.live",
    "hand..ticks.time",
    // image counts that the summary omits
    "bodies.contact.pair..faces",
    "bodies.contact.pair..hits",
    "bodies.contact.pair..pixels",
    "bodies.contact.pair..vertices",
    // used for poses so deep that the skin gives no exit direction, and by runs that take steps in parts
    "bodies.contact.pair..finder.",
    "bodies.contact.pair..normal",
    "bodies.contact.pair..presses",
    "bodies.contact.pair..thickness",
    // used when the clock stops, and when poses are missing
    "bodies.hand..limiter.stalled",
    "bodies.hand..limiter.held",
    "bodies.hand..limiter.last_valid",
    "bodies.hand..limiter.last_length",
    "hand..ticks.handle.valid",
    // fingers do not yield: a path defines its switches at every time
    "hand..ticks.handle.switches",
    "bodies.hand..device.switches",
    // maxima that these scenes reach later (tested by MaterialPoints.SumsErrorsLargestOnesGoOn)
    "bodies.contact.pair..sum_error.largest_",
    // a maximum as well: only images jump, and deeper contact jumps more
    "bodies.contact.largest_jump.",
    // near samples that do not press
    "bodies.contact.pair..near",
    // a maximum of a constant area, and an estimate used only by an active controller
    "bodies.contact.largest_grasped_area",
    "bodies.hand..passivity.observer.change",
    // already counted from the acting wrench
    "bodies.hand..device.motors.next",
    "bodies.hand..motors.next",
    "bodies.hand..passivity.reductions.next",
    // replaced by the second tick after the checkpoint
    "bodies.energy.work_of_hand..at_coarse",
    // these scenes have no moving support
    "bodies.energy.work_of_supports.",
};
bool is_shown_nowhere(const std::string& name) {
  return std::any_of(kShownNowhere.begin(), kShownNowhere.end(),
                     [&](const std::string& beginning) { return name.starts_with(beginning); });
}

/// Removes indices: "bodies.hand.0.limiter.live" of any hand.
std::string without_numbers(const std::string& name) {
  std::string out;
  for (const char c : name)
    if (c < '0' || c > '9') out += c;
  return out;
}

// A missing value is reported by name. A changed value changes the resumed run in at least one of the scenes.
TEST(CheckpointValues, MatterEachAndAll) {
  std::set<std::string> matters, idle;
  for (const std::string& scene : case_names()) {
    SCOPED_TRACE(scene);
    const Case c = find_case(scene);
    const Outcome whole = with_checkpoints(c);
    ASSERT_FALSE(whole.checkpoints.empty());
    const Archive::Values& kept = whole.checkpoints[c.telling].values();
    for (const auto& [name, value] : kept) {
      const std::string plain_name = without_numbers(name);
      if (is_time_of_day(name) || matters.contains(plain_name)) continue;
      Archive::Values other = kept;
      if (!change(other[name])) continue;
      std::string seen;
      try {
        seen = difference(with_checkpoints(c, &other), whole);
      } catch (const std::exception& refused) { seen = refused.what(); }
      if (!seen.empty()) matters.insert(plain_name);
      if (!idle.insert(plain_name).second) continue;
      Archive::Values less = kept;
      less.erase(name);
      EXPECT_THROW(with_checkpoints(c, &less), Error) << name << " may be missing";
    }
  }
  EXPECT_GT(matters.size(), kAllScenes ? 100u : 50u);
  if (!kAllScenes) return;
  for (const std::string& name : idle)
    EXPECT_TRUE(matters.contains(name) || is_shown_nowhere(name)) << name << " may be anything";
}

TEST(CheckpointsRefused, WhereThereCanBeNone) {
  const Case c = falling_body("linearly-implicit-euler");
  const auto message = [&](double every_s) -> std::string {
    try {
      loop::check_checkpoints(c.scene, every_s, 0.0);
    } catch (const Error& error) { return error.what(); }
    return {};
  };
  EXPECT_EQ(message(c.every_s), "");
  EXPECT_NE(message(1e-5).find("which is 0.002 s in this scene"), std::string::npos) << message(1e-5);
  EXPECT_NE(message(1.0).find("before the first checkpoint"), std::string::npos) << message(1.0);
}

TEST(CheckpointsRefused, ThoseOfAnotherScene) {
  const Case one = find_case(case_names().front()), other = falling_body("rk4");
  const Outcome whole = with_checkpoints(one);
  try {
    with_checkpoints(other, &whole.checkpoints[0].values());
    ADD_FAILURE() << "taken";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("one/checkpoint.h5"), std::string::npos) << error.what();
  }
}

}  // namespace
