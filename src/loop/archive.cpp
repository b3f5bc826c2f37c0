// State of a run in a checkpoint, and how a run resumes from it (checkpoints.cpp).
//
// A checkpoint contains the data that determine the future and are stored nowhere else: the State, hands and
// their devices, grasps of the tools, normals that contact kept from earlier queries, records not yet in
// force, sums and counters. It does not contain derived data: matrices and factors, histories of multistep
// methods, step sizes, initial guesses, contact samples. These restart, in the resumed run as in the run that
// was interrupted.
#include <algorithm>

#include "body_loop.h"
#include "core/clock.h"
#include "palpate/core/error.h"
#include "virtual_time.h"

namespace palpate::loop {
namespace {

void archive_state(Archive& a, dynamics::State& state) {
  double time = state.time();
  a("time", time);
  state.set_time(time);
  const auto part = [&](std::string_view name, Eigen::Map<VecX> values) {
    a.numbers(name, {values.data(), static_cast<std::size_t>(values.size())});
  };
  part("q", state.q());
  part("u", state.u());
}

void archive_tool(Archive& a, tool::Tool& tool) {
  double time = tool.time();
  Pose pose = tool.pose();
  Twist twist = tool.twist();
  a("time", time);
  a("pose", pose);
  a("twist", twist);
  if (a.is_restoring()) tool.set_state(time, pose, twist);
}

void archive_partitioned(Archive& a, PartitionedTool& partitioned) {
  contact::TrajectoryFrame::Knot exchanged = partitioned.path->last();
  a("known_time", exchanged.t);
  a("known_pose", exchanged.pose);
  a("known_twist", exchanged.twist);
  if (a.is_restoring()) {
    partitioned.path->clear();
    partitioned.path->append(exchanged.t, exchanged.pose, exchanged.twist);
  }
  if (partitioned.reduction) {
    const Archive::Group group(a, "answers");
    partitioned.reduction->archive(a);
  }
  const Archive::Group group(a, "tool");
  archive_tool(a, partitioned.tool);
  if (partitioned.rigid_contact) partitioned.rigid_contact->query_next();
}

void archive_hand(Archive& a, ToolInstance& tool) {
  if (PartitionedTool* partitioned = tool.partitioned()) archive_partitioned(a, *partitioned);
  a("handle_now", tool.handle);
  {
    const Archive::Group group(a, "device");
    tool.device->archive(a);
  }
  a("limiter", tool.limiter);
  a("motors", tool.motors);
  if (tool.passivity) a("passivity", *tool.passivity);
}

}  // namespace

void BodyLoop::query_before_checkpoint() {
  if (!world_.contact) return;
  if (ledger_) ledger_->before_query();
  {
    const ScopedTimer timer(result_.query_s);
    world_.contact->refresh(world_.state.view());
  }
  if (ledger_) ledger_->after_query();
}

/// Repeats the changes of change_materials() up to now, in order of time.
void BodyLoop::change_materials_so_far() {
  const double last = changed_;
  for (changed_ = 0.0;;) {
    const double next = next_change();
    if (!(next <= last)) break;
    changed_ = next;
    for (std::size_t i = 0; i < world_.bodies.size(); ++i)
      for (const MaterialChangeSpec& change : world_.description.bodies[i].changes)
        if (change.time_s == next)
          world_.set_youngs_modulus(world_.bodies[i], change.youngs_modulus_pa, change.region);
  }
  changed_ = last;
}

void BodyLoop::archive_counts(Archive& a) {
  if (!a.is_restoring()) sum_up();
  visit_counters([&](const char* name, auto& value) { a(name, value); }, result_);
  a("most_halvings", result_.counters.most_halvings);
  a("ordering", result_.counters.solver.ordering);
  if (a.is_restoring()) counted_before_ = result_.counters;
}

void BodyLoop::archive(Archive& a) {
  {
    const Archive::Group group(a, "state");
    archive_state(a, world_.state);
  }
  a("changed", changed_);
  if (a.is_restoring()) change_materials_so_far();
  a.each("hand", world_.tools, [&](ToolInstance& tool) { archive_hand(a, tool); });
  a.each("felt", hand_ticks_, [&](HandTicks& felt) {
    a("version", felt.version);
    a("ticks", felt.ticks);
    if (felt.vibration) a("buzz", *felt.vibration);
  });
  if (a.is_restoring()) {
    restart_path();
    if (world_.stepper) {
      world_.stepper->set_interrupt(options_.stop);
      world_.stepper->reinit(dynamics::ReinitReason::kStateChanged);
    }
  }
  if (world_.contact) {
    const Archive::Group group(a, "contact");
    world_.contact->archive(a, world_.state.view());
  }
  const auto& observers = options_.observers;
  if (std::any_of(observers.begin(), observers.end(), [](const Observer* o) { return o->wants_energy(); })) {
    if (a.is_restoring()) ledger_.emplace(world_);
    const Archive::Group group(a, "energy");
    ledger_->archive(a);
    if (a.is_restoring()) result_.energy = ledger_->balance();
  }
  const Archive::Group group(a, "counts");
  archive_counts(a);
}

void VirtualTime::archive(Archive& a) {
  a("periods", periods_);
  if (dense_) a("dense", *dense_);
  a.each("hand", hands_, [&](Hand& hand) {
    a("ticks", hand.haptic_loop);
    a("count", hand.count);
    a.bytes("in_force", hand.in_force);
    a.list("coming", hand.coming, [&](Coming& coming) {
      a("tick", coming.tick);
      a.bytes("record", coming.record);
    });
  });
  const Archive::Group group(a, "bodies");
  bodies_.archive(a);
}

}  // namespace palpate::loop
