#include "palpate/device/handle.h"

namespace palpate::device {
namespace {

/// A hand that follows keyframes, whatever it feels.
class ScriptHandle : public Handle {
 public:
  explicit ScriptHandle(const DeviceSpec& spec) : keyframes_(spec.keyframes) {
    check_keyframes(keyframes_, "device");
  }
  HandleSample sample(double t) override { return sample_keyframes(keyframes_, t); }

 private:
  std::vector<KeyframeSpec> keyframes_;
};

}  // namespace

const Registry<MakeHandle>& handle_registry() {
  static const Registry<MakeHandle> registry = {
      {"script",
       "follows the keyframes of the scene",
       0,
       [](const DeviceSpec& spec) -> std::unique_ptr<Handle> { return std::make_unique<ScriptHandle>(spec); },
       {{.name = "keyframe", .required = true}}},
  };
  return registry;
}

std::unique_ptr<Handle> make_handle(const DeviceSpec& spec) {
  return find(handle_registry(), spec.type, "device type").make(spec);
}

}  // namespace palpate::device
