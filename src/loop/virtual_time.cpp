#include "virtual_time.h"

#include "core/clock.h"

namespace palpate::loop {

VirtualTime::VirtualTime(World& world, BodyLoop& bodies, const RunOptions& options, RunResult& result)
    : world_(world), bodies_(bodies), options_(options), result_(result) {
  make_hands();
  for (Hand& hand : hands_) hand.haptic_loop.start(0.0);
  bodies.restart_path();
  bodies.start();
  if (single_) single_->start();
}

VirtualTime::VirtualTime(World& world, BodyLoop& bodies, const RunOptions& options, RunResult& result,
                         Archive& from)
    : world_(world), bodies_(bodies), options_(options), result_(result) {
  make_hands();
  archive(from);
}

void VirtualTime::make_hands() {
  const scene::Description& d = world_.description;
  if (!d.tool) return;
  check_clock(world_, false);
  for (ToolInstance& tool : world_.tools) hands_.emplace_back(d, tool);
  if (!world_.monolithic()) {
    groups_ = TickGroup::all(hands_);
    return;
  }
  if (d.exchange.scheme == scene::ExchangeScheme::kSingleRate) {
    std::vector<HapticLoop*> loops;
    for (Hand& hand : hands_) loops.push_back(&hand.haptic_loop);
    single_.emplace(world_, bodies_, result_, std::move(loops));
    return;
  }
  dense_.emplace(world_, [this](std::size_t hand, TickRecord tick) {
    hands_[hand].haptic_loop.render_force(tick);
    bodies_.record_tick(hand, tick);
  });
  bodies_.set_ticks(&*dense_);
}

bool VirtualTime::next() {
  if (periods_ == bodies_.periods()) return false;
  result_.stopped = options_.stop && options_.stop->load();
  if (result_.stopped) return false;
  one_period(bodies_.period_start(periods_), bodies_.period_start(periods_ + 1));
  if (bodies_.ended()) return false;
  bodies_.close_period(bodies_.period_start(++periods_));
  return true;
}

void VirtualTime::end() {
  for (Hand& hand : hands_) hand.haptic_loop.end();
}

void VirtualTime::one_period(double t0, double t1) {
  if (single_) return tick_everything(t1);
  bodies_.query();
  // Ticks use the contact found before them, so they stop where the next query is due.
  for (double t = t0, next;; t = next) {
    const bool exchanged = world_.has_tool_of_ticks();
    next = exchanged ? bodies_.next_query(t, t1) : t1;
    if (exchanged) tick_tools(t, next);
    if (!result_.status.ok()) return;
    bodies_.advance(t, next, world_.description.exchange.contact_refresh_s);
    if (!result_.status.ok() || next >= t1) return;
    bodies_.query();
  }
}

/// Runs the ticks of a period of the single-rate scheme.
void VirtualTime::tick_everything(double t1) {
  const long first = static_cast<long>(periods_) * single_->ticks_per_period(),
             last =
                 periods_ + 1 == bodies_.periods() ? single_->count() : first + single_->ticks_per_period();
  for (long i = first; i < last && result_.status.ok(); ++i) {
    single_->query_if_due(single_->time_of(i), t1);
    single_->tick(single_->time_of(i), i + 1 == last ? t1 : single_->time_of(i + 1));
  }
}

/// Passes the bodies' record to every hand, then runs each group of hands that meet through the period.
void VirtualTime::tick_tools(double t0, double t1) {
  for (std::size_t i = 0; i < hands_.size(); ++i) adopt(hands_[i], bodies_.linearise(i, t1 - t0));
  bodies_.restart_path();
  const ScopedTimer timer(result_.tool_s);
  for (TickGroup& group : groups_) {
    const int ticks = whole_number((t1 - t0) / hands_[group.members().front().hand].tick_s);
    const double h = (t1 - t0) / ticks;
    for (int i = 0; i < ticks && result_.status.ok(); ++i) tick(group, t0 + (i + 1) * h, h);
  }
}

/// A record comes into force after latency_ticks; the first record of a run at once.
void VirtualTime::adopt(Hand& hand, const ContactRecord& record) {
  const int latency = record.linear.version == 1 ? 0 : world_.description.exchange.latency_ticks;
  if (latency == 0)
    hand.in_force = record;
  else
    hand.coming.push_back({hand.count + latency, record});
}

const ContactRecord& VirtualTime::record_of(Hand& hand) {
  for (; !hand.coming.empty() && hand.coming.front().tick <= hand.count; hand.coming.pop_front())
    hand.in_force = hand.coming.front().record;
  ++hand.count;
  return hand.in_force;
}

void VirtualTime::tick(TickGroup& group, double t, double h) {
  group.find_contact(t, h, [&](std::size_t hand) -> const ContactRecord& { return record_of(hands_[hand]); });
  for (std::size_t i = 0; i < group.members().size(); ++i) {
    const auto [hand, haptic_loop] = group.members()[i];
    TickRecord tick;
    result_.status = haptic_loop->tick(t, h, group.contact(i), tick);
    if (!result_.status.ok()) return;
    bodies_.follow(hand, t, tick.tool, tick.tool_twist);
    bodies_.record_tick(hand, tick);
  }
}

void run_in_virtual_time(World& world, BodyLoop& bodies, const RunOptions& options, RunResult& result) {
  VirtualTime clock(world, bodies, options, result);
  while (clock.next()) {}
  clock.end();
}

}  // namespace palpate::loop
