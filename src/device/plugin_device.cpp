// A driver in a shared object, by the C interface of palpate/device/plugin.h.
#include "palpate/device/plugin.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "device/make.h"
#include "palpate/core/error.h"
#include "palpate/device/profile.h"
#include "plugin_library.h"

namespace palpate::device {
namespace {

/// Cut-off of the velocities that are derived from poses [1/s].
constexpr double kVelocityCutoff = 100.0;

Vec3 vec_of(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

void write(const Vec3& v, double (&out)[3]) { std::copy(v.begin(), v.end(), out); }

class PluginDevice : public Device {
 public:
  PluginDevice(const DeviceSpec& spec, const std::string& folder)
      : library_(spec.library, spec.library_options, folder) {
    specification_ = figures_of(with_reported_limits(spec, *this)).specification;
    if (specification_.name == spec.type) specification_.name = library_.specification().name;
    if (!specification_.max_stiffness) specification_.max_stiffness = library_.specification().max_stiffness;
    last_.rotation_wxyz[0] = 1.0;
    write(spec.start_position_m.value_or(spec.workspace_center_m), last_.position_m);
  }
  ~PluginDevice() override { close(); }
  DeviceSpecification specification() const override { return specification_; }
  std::optional<DeviceSpecification> reported() const override { return library_.specification(); }
  bool is_live() const override { return library_.needs_real_time(); }
  void bound(const PoseBounds& bounds) override { bounds_ = bounds; }
  std::vector<std::pair<std::string, long long>> counters() const override {
    return {{"poses_accepted", accepted_},
            {"poses_not_finite", not_finite_},
            {"poses_out_of_bounds", out_of_bounds_},
            {"us_in_longest_driver_call",
             std::chrono::duration_cast<std::chrono::microseconds>(longest_).count()}};
  }

 protected:
  void do_open() override {
    library_.call("open", [&] { return library_.table().open(library_.options().c_str(), &device_); });
  }
  void do_close() override {
    try {
      library_.call("close", [&] { return library_.table().close(device_), nullptr; });
    } catch (const Error&) {}  // an exception in a driver's close leaves nothing to be done
    device_ = nullptr;
  }
  HandleSample do_sample(double t) override {
    PalpatePluginSample read = last_;
    timed("sample", [&] { return library_.table().sample(device_, t, &read); });
    HandleSample out;
    if (!library_.has_velocities()) derive_velocities(t, read);
    out.valid = read.valid != 0 && accept(t, read);
    out.pose = pose_of(last_);
    out.twist = twist_of(last_);
    out.switches = last_.switches;
    return out;
  }
  void do_feedback(double t, const Wrench& on_hand) override {
    if (!library_.has_motors()) return;
    PalpatePluginWrench sent;
    write(on_hand.force, sent.force_n);
    write(on_hand.moment, sent.torque_n_m);
    timed("feedback", [&] { return library_.table().feedback(device_, t, &sent); });
  }

 private:
  using Clock = std::chrono::steady_clock;

  static Pose pose_of(const PalpatePluginSample& s) {
    const double* const q = s.rotation_wxyz;
    return {Quat(q[0], q[1], q[2], q[3]).normalized(), vec_of(s.position_m)};
  }
  static Twist twist_of(const PalpatePluginSample& s) {
    return {vec_of(s.angular_velocity_rad_s), vec_of(s.linear_velocity_m_s)};
  }

  /// Writes velocities from the change since the last accepted pose: the backward difference through a
  /// first-order low pass. Zero until the second pose.
  void derive_velocities(double t, PalpatePluginSample& s) {
    if (const double h = t - accepted_at_; accepted_ > 0 && h > 0.0 && s.valid != 0) {
      const double share = -std::expm1(-2.0 * std::numbers::pi * kVelocityCutoff * h);
      rate_ += share * (pose_difference(pose_of(last_), pose_of(s)) / h - rate_);
      if (!rate_.allFinite()) rate_.setZero();  // the pose is not finite, and accept() counts it
    }
    write(rate_.head<3>(), s.angular_velocity_rad_s);
    write(rate_.tail<3>(), s.linear_velocity_m_s);
  }

  /// Checks a pose and adopts it; returns whether it was accepted. Others are counted.
  bool accept(double t, const PalpatePluginSample& s) {
    const Eigen::Map<const Eigen::Vector4d> q(s.rotation_wxyz);
    const Twist twist = twist_of(s);
    if (!vec_of(s.position_m).allFinite() || !twist.linear.allFinite() || !twist.angular.allFinite() ||
        !(std::abs(q.norm() - 1.0) < 1e-3))
      return ++not_finite_, false;
    if (!bounds_.hold(pose_of(s), twist)) return ++out_of_bounds_, false;
    last_ = s;
    accepted_at_ = t;
    ++accepted_;
    return true;
  }

  template <class Work>
  void timed(const char* function, const Work& work) {
    const Clock::time_point before = Clock::now();
    library_.call(function, work);
    longest_ = std::max(longest_, Clock::now() - before);
  }

  PluginLibrary library_;
  DeviceSpecification specification_;
  PoseBounds bounds_;
  void* device_ = nullptr;      ///< State of the driver, null while it is closed.
  PalpatePluginSample last_{};  ///< Last accepted sample.
  double accepted_at_ = 0.0;    ///< Its time [s].
  Vec6 rate_ = Vec6::Zero();    ///< Velocities from poses: angular [rad/s], linear [m/s].
  long long accepted_ = 0, not_finite_ = 0, out_of_bounds_ = 0;
  Clock::duration longest_{0};  ///< Longest call of sample or feedback.
};

}  // namespace

std::unique_ptr<Device> make_plugin(const DeviceSpec& spec, const std::string& folder) {
  if (spec.library.empty()) fail("device: library is missing; set it to the shared object of the driver");
  return std::make_unique<PluginDevice>(spec, folder);
}

}  // namespace palpate::device
