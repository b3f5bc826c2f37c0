// Renders to a custom device: its handle rises at 2 cm/s, and it averages the force that its motors receive.
// The tool hangs on the handle by the virtual coupling. Once it has stopped swinging, the hand carries its
// weight m g.
#include <cstdio>
#include <memory>
#include <utility>

#include "palpate/device/device.h"
#include "palpate/loop/load.h"
#include "palpate/loop/run.h"

using namespace palpate;

/// Sum of the force on the hand over ticks.
struct ForceSum {
  double newtons = 0.0;  ///< Along z [N].
  int ticks = 0;
};

class Lift : public device::Device {
 public:
  explicit Lift(std::shared_ptr<ForceSum> sum) : sum_(std::move(sum)) {}
  device::DeviceSpecification specification() const override { return {.name = "lift"}; }

 protected:
  /// Returns the handle's pose and velocity at time t [s]; a driver reads its hardware here, without waiting.
  device::HandleSample do_sample(double t) override {
    device::HandleSample sample;
    sample.pose.translation = {0.0, 0.0, 0.02 * t};
    sample.twist.linear = {0.0, 0.0, 0.02};
    return sample;
  }
  /// Receives the wrench for the hand, already limited; a driver sends it to its motors here.
  void do_feedback(double t, const Wrench& on_hand) override {
    if (t < 1.0 || t > 1.5 - 1e-9) return;  // still swinging; the last call sets the motors to zero
    sum_->newtons += on_hand.force.z();
    ++sum_->ticks;
  }

 private:
  std::shared_ptr<ForceSum> sum_;
};

int main() {
  // The scene describes the tool; its [device] table has the limits of the force. The device of the program
  // replaces the scene's keyframes.
  const scene::Description description = loop::parse(R"(
[scene]
name = "weight"
duration_s = 1.5
gravity_m_s2 = [0.0, 0.0, -9.81]
[tool]
mass_kg = 0.1
gravity = true
[device]
[[device.keyframe]]
time_s = 0.0
)",
                                                     "weight.toml");
  const auto sum = std::make_shared<ForceSum>();
  const auto world = loop::assemble(description, std::make_unique<Lift>(sum));
  const loop::RunResult result = loop::run(*world, {});
  std::printf("%s: %ld ticks, tool at %.4g m; on the hand %.4g N, by theory -m g = %.4g N\n",
              to_string(result.status.status), result.ticks, world->tool_pose().translation.z(),
              sum->newtons / sum->ticks, -0.1 * 9.81);
}
