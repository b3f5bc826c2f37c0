// A device of one's own: its handle rises at 2 cm/s, and it adds up what its motors are told.  The tool hangs
// on the handle by the virtual coupling; once it has stopped swinging, the hand feels its weight.
#include <cstdio>
#include <memory>
#include <utility>

#include "palpate/device/device.h"
#include "palpate/loop/load.h"
#include "palpate/loop/run.h"

using namespace palpate;

struct Felt {
  double sum = 0.0;  ///< of the forces along z [N]
  int count = 0;
};

class Lift : public device::Device {
 public:
  explicit Lift(std::shared_ptr<Felt> felt) : felt_(std::move(felt)) {}
  device::DeviceSpecification specification() const override { return {.name = "lift"}; }

 protected:
  device::HandleSample do_sample(double t) override {  // where hardware would be asked
    device::HandleSample sample;
    sample.pose.translation = {0.0, 0.0, 0.02 * t};
    sample.twist.linear = {0.0, 0.0, 0.02};
    return sample;
  }
  void do_feedback(double t, const Wrench& on_hand) override {  // where its motors are told
    if (t < 1.0 || t > 1.5 - 1e-9) return;                      // still swinging; at the end they are let go
    felt_->sum += on_hand.force.z();
    ++felt_->count;
  }

 private:
  std::shared_ptr<Felt> felt_;
};

int main() {
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
  const auto felt = std::make_shared<Felt>();
  const auto world = loop::assemble(description, std::make_unique<Lift>(felt));
  const loop::RunResult result = loop::run(*world, {});
  std::printf("%s: %ld ticks, tool at %.4g m; on the hand %.4g N, by theory -m g = %.4g N\n",
              to_string(result.status.status), result.ticks, world->tool_pose().translation.z(),
              felt->sum / felt->count, -0.1 * 9.81);
}
