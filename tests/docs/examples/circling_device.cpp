#include <cmath>

#include "palpate/device/device.h"
#include "palpate/device/profile.h"

namespace palpate::device {
namespace {

/// A handle that moves on a circle of 1 cm around the origin, independent of the force.  It stores the last
/// force, as motors hold it.
class CirclingDevice : public Device {
 public:
  explicit CirclingDevice(const DeviceSpec& spec) : specification_(figures_of(spec).specification) {}
  DeviceSpecification specification() const override { return specification_; }

 protected:
  void do_open() override {}  // open the hardware; fail("device: ...") if it does not respond
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
  DeviceSpecification specification_;
  Wrench on_hand_;
};

}  // namespace

std::unique_ptr<Device> make_circling(const DeviceSpec& spec, const std::string&) {
  return std::make_unique<CirclingDevice>(spec);
}

}  // namespace palpate::device
