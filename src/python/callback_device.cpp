// A hand that is moved by a Python function, which is called once per tick with the force of the tick before.
#include "callback_device.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "arrays.h"
#include "bindings.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Reads `count` finite numbers.
VecX read_numbers(const py::handle& value, const std::string& what, int count) {
  const Numbers numbers = Numbers::ensure(value);
  if (!numbers) {
    PyErr_Clear();
    fail("{} must be {} numbers", what, count);
  }
  if (numbers.size() != count) fail("{} must be {} numbers, and has {}", what, count, numbers.size());
  const VecX out = Eigen::Map<const VecX>(numbers.data(), count);
  if (!out.allFinite()) fail("{} must be {} finite numbers", what, count);
  return out;
}

Quat read_rotation(const py::handle& value) {
  const VecX q = read_numbers(value, "rotation", 4);
  if (std::abs(q.norm() - 1.0) > 1e-3)
    fail("rotation must be a unit quaternion w, x, y, z; its norm is {}", q.norm());
  return Quat(q[0], q[1], q[2], q[3]).normalized();
}

HandlePose make_pose(const py::object& position, const py::object& rotation, const py::object& velocity,
                     const py::object& angular_velocity, std::uint32_t switches, bool valid) {
  HandlePose out;
  out.pose.translation = read_numbers(position, "position", 3);
  if (!rotation.is_none()) out.pose.rotation = read_rotation(rotation);
  if (!velocity.is_none()) out.velocity = Vec3(read_numbers(velocity, "velocity", 3));
  if (!angular_velocity.is_none())
    out.angular_velocity = Vec3(read_numbers(angular_velocity, "angular_velocity", 3));
  out.switches = switches;
  out.valid = valid;
  return out;
}

class CallbackDevice : public device::Device {
 public:
  /// @param start  orientation of a handle whose function returns positions only
  CallbackDevice(py::object function, std::string hand, Quat start)
      : function_(std::move(function)), hand_(std::move(hand)), start_(start) {}
  ~CallbackDevice() override {
    const py::gil_scoped_acquire acquire;
    function_.release().dec_ref();
  }
  device::DeviceSpecification specification() const override {
    device::DeviceSpecification out;
    out.name = "Python function";
    return out;
  }

 protected:
  device::HandleSample do_sample(double t) override {
    if (sampled_at_ && *sampled_at_ == t) return last_;
    const HandlePose next = call(t);
    device::HandleSample out;
    out.pose = next.pose;
    const double h = sampled_at_ ? t - *sampled_at_ : 0.0;
    const Vec6 change = h > 0.0 ? Vec6(pose_difference(last_.pose, next.pose) / h) : Vec6(Vec6::Zero());
    out.twist.linear = next.velocity.value_or(change.tail<3>());
    out.twist.angular = next.angular_velocity.value_or(change.head<3>());
    out.switches = next.switches;
    out.valid = next.valid;
    sampled_at_ = t;
    return last_ = out;
  }
  void do_feedback(double, const Wrench& on_hand) override { on_hand_ = on_hand; }

 private:
  HandlePose call(double t) const {
    const py::gil_scoped_acquire acquire;
    const py::object result = function_(t, copied(on_hand_.force), copied(on_hand_.moment));
    if (py::isinstance<HandlePose>(result)) return result.cast<HandlePose>();
    HandlePose out;
    out.pose.translation = read_numbers(
        result, fmt::format("hand \"{}\" at t = {:g} s: the position that its function returned", hand_, t),
        3);
    out.pose.rotation = start_;
    return out;
  }

  py::object function_;
  std::string hand_;
  Quat start_;
  std::optional<double> sampled_at_;
  device::HandleSample last_;
  Wrench on_hand_;
};

}  // namespace

std::vector<std::unique_ptr<device::Device>> callback_devices(const py::object& hands,
                                                              const scene::Description& description) {
  std::vector<std::unique_ptr<device::Device>> out;
  if (hands.is_none()) return out;
  const std::vector<scene::Hand> known = scene::hands_of(description);
  if (known.empty() || !known.front().tool)
    fail("hands: the scene has no [tool], so there is no hand to move");
  if (description.exchange.scheme == scene::ExchangeScheme::kMonolithic)
    fail(
        "hands: exchange.scheme = \"monolithic\" needs the path of the handle in advance; use "
        "\"partitioned\" or \"single_rate\"");
  std::map<std::string, py::object> functions;
  if (PyCallable_Check(hands.ptr()))
    functions[known.front().name] = hands;
  else
    functions = hands.cast<std::map<std::string, py::object>>();
  std::vector<std::string> names;
  for (const scene::Hand& hand : known) {
    names.push_back(hand.name);
    const auto found = functions.find(hand.name);
    if (found == functions.end()) {
      out.push_back(nullptr);
      continue;
    }
    if (!PyCallable_Check(found->second.ptr())) fail("hands: \"{}\" is not a function", hand.name);
    out.push_back(std::make_unique<CallbackDevice>(found->second, hand.name,
                                                   quaternion_of(hand.tool->rotation_vector_rad)));
  }
  for (const auto& [name, function] : functions)
    if (std::find(names.begin(), names.end(), name) == names.end())
      fail("the scene has no hand \"{}\"{}", name, suggestion(name, names));
  return out;
}

void bind_handle_pose(py::module_& module) {
  py::class_<HandlePose>(module, "HandlePose",
                         "Pose of a handle, as a function given to `Simulation(hands=...)` may return it.")
      .def(
          py::init(&make_pose), py::arg("position"), py::arg("rotation") = py::none(),
          py::arg("velocity") = py::none(), py::arg("angular_velocity") = py::none(), py::arg("switches") = 0,
          py::arg("valid") = true,
          "position [m]; rotation: unit quaternion w, x, y, z; velocity [m/s] and angular_velocity [rad/s]:\n"
          "None computes them from the tick before; switches: bit i is switch i; valid: False if there is\n"
          "no new pose, and the force must fall to zero.")
      .def_property_readonly("position", [](const HandlePose& self) { return copied(self.pose.translation); })
      .def_property_readonly("rotation", [](const HandlePose& self) { return copied(self.pose.rotation); })
      .def_readonly("switches", &HandlePose::switches)
      .def_readonly("valid", &HandlePose::valid);
}

}  // namespace palpate::python
