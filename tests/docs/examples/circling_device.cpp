#include <cmath>

#include "palpate/device/device.h"

namespace palpate::device {
namespace {

/// A handle that circles, 1 cm around the origin, whatever it feels; it keeps the last force, as motors
/// would.
class CirclingDevice : public Device {
 public:
  DeviceSpecification specification() const override { return {}; }

 protected:
  void do_open() override {}  // take hold of the hardware; fail("device: ...") where it does not answer
  void do_close() override { on_hand_ = {}; }
  HandleSample do_sample(double t) override {
    constexpr double kRadius = 0.01, kRate = 2.0;  // [m], [rad/s]
    const Vec3 outward(std::cos(kRate * t), std::sin(kRate * t), 0.0), along(-outward.y(), outward.x(), 0.0);
    HandleSample out;  // the scene's axes, m and rad
    out.pose.translation = kRadius * outward;
    out.twist.linear = kRadius * kRate * along;
    out.acceleration.linear = -kRadius * kRate * kRate * outward;
    return out;
  }
  void do_feedback(double, const Wrench& on_hand) override { on_hand_ = on_hand; }  // limited already

 private:
  Wrench on_hand_;
};

}  // namespace

std::unique_ptr<Device> make_circling(const DeviceSpec&, const std::string&) {
  return std::make_unique<CirclingDevice>();
}

}  // namespace palpate::device
