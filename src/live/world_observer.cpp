#include "live/world_observer.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "core/clock.h"
#include "palpate/scene/hands.h"

namespace palpate::live {
namespace {

enum Flag : std::uint32_t { kValid = 1, kLimited = 2, kInContact = 4 };

/// Writes floats one after the other.
struct Pen {
  float* at;
  void add(double value) { *at++ = static_cast<float>(value); }
  void add(const Vec3& v) {
    for (Eigen::Index i = 0; i < 3; ++i) add(v[i]);
  }
  void add(const Pose& pose) {
    add(pose.translation);
    const Quat& q = pose.rotation;
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) add(value);
  }
};

std::uint32_t flags_of(const loop::TickRecord& tick) {
  return (tick.handle_valid ? kValid : 0U) | (tick.limited ? kLimited : 0U) |
         (tick.contact.force.squaredNorm() > 0.0 ? kInContact : 0U);
}

}  // namespace

void WorldObserver::attach(std::shared_ptr<LiveScene> scene, const loop::World& world) {
  scene_ = std::move(scene);
  const scene::Description& d = world.description;
  const std::vector<scene::Hand> hands = scene::hands_of(d);
  hands_.assign(hands.size(), {});
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    hands_[i].tick.tool = {quaternion_of(hands[i].tool->rotation_vector_rad), hands[i].tool->position_m};
    hands_[i].tick.handle = hands_[i].tick.tool;
  }
  timing_ = TimingWindow(d.tool ? d.tool->tick_s : loop::period_of(d));
  ports_.assign(hands_.size(), device::PassivityObserver());
  port_energy_ = least_port_energy_ = 0.0;
  may_compute_energy_ = d.exchange.scheme != scene::ExchangeScheme::kSingleRate;
  last_frame_ = last_status_ = -1.0;
  next_energy_ = 0.0;
  status_ = {};
}

void WorldObserver::period(loop::World& world, double t) {
  change_moduli(world);
  if (scene_->watched.load(std::memory_order_relaxed) || last_frame_ < 0.0)
    if (last_frame_ < 0.0 || t - last_frame_ >= kFramePeriod) write_frame(world, t);
  if (last_status_ < 0.0 || t - last_status_ >= 0.1) write_status(world, t);
}

void WorldObserver::tick_of(std::size_t hand, const loop::TickRecord& tick) {
  hands_[hand].tick = tick;
  hands_[hand].ticked = true;
  scene_->strip.add(hand, tick.time, tick.device);
  device::PassivityObserver& port = ports_[hand];
  port_energy_ -= port.energy();
  port.hold(tick.motors);
  port.sample(tick.time, tick.handle);
  port_energy_ += port.energy();
  // the hands of one tick come one after the other, and energy passes between them
  if (hand + 1 == ports_.size()) least_port_energy_ = std::min(least_port_energy_, port_energy_);
}

void WorldObserver::timed(const loop::TickTiming& timing) {
  timing_.add(wall_seconds(), static_cast<double>(timing.lateness_s), static_cast<double>(timing.work_s),
              static_cast<std::int64_t>(timing.skipped) + timing.left_out);
}

void WorldObserver::change_moduli(loop::World& world) {
  for (std::size_t i = 0; i < scene_->moduli.size(); ++i) {
    std::atomic<double>& pending = scene_->moduli[i];
    if (pending.load(std::memory_order_relaxed) == 0.0) continue;
    if (const double modulus = pending.exchange(0.0); modulus > 0.0)
      world.set_youngs_modulus(world.bodies[i], modulus);
  }
}

void WorldObserver::write_frame(loop::World& world, double t) {
  Frame& frame = scene_->frames.back();
  frame.time_s = t;
  Pen pen{frame.values.data()};
  const dynamics::StateView view = world.state.view();
  for (const loop::Body& body : world.bodies) {
    const dynamics::Block& block = *view.layout->find(body.block_id);
    const double* q = view.q.data() + block.q_offset;
    pen.at = std::transform(q, q + 3 * body.placed.cols(), pen.at,
                            [](double value) { return static_cast<float>(value); });
  }
  for (const HandState& hand : hands_) pen.add(hand.tick.tool);
  for (const loop::Bone& bone : world.bones) pen.add(world.bone_pose(bone));
  for (const HandState& hand : hands_) {
    pen.add(hand.tick.handle);
    pen.add(hand.tick.device.force);
    pen.add(hand.tick.device.moment);
    *pen.at++ = std::bit_cast<float>(hand.ticked ? flags_of(hand.tick) : std::uint32_t{kValid});
  }
  scene_->frames.publish();
  last_frame_ = t;
}

void WorldObserver::update_energy(loop::World& world) {
  if (!may_compute_energy_ || !scene_->watched.load(std::memory_order_relaxed)) return;
  const double start = wall_seconds();
  if (start < next_energy_) return;
  // Without tools: those belong to the ticks.
  const dynamics::StateView view = world.state.view();
  status_.energy_j = world.system.kinetic_energy(view) + world.system.potential_energy(view);
  status_.has_energy = true;
  next_energy_ = start + std::max(0.2, 50.0 * (wall_seconds() - start));
}

void WorldObserver::write_status(loop::World& world, double t) {
  update_energy(world);
  timing_.write(status_);
  status_.time_s = t;
  status_.port_energy_j = port_energy_;
  status_.least_port_energy_j = least_port_energy_;
  scene_->status.publish(status_);
  last_status_ = t;
}

}  // namespace palpate::live
