#include "device/make.h"

namespace palpate::device {
namespace {

/// A hand that follows keyframes, whatever it feels.
class ScriptHandle : public Handle {
 public:
  explicit ScriptHandle(const DeviceSpec& spec) : keyframes_(spec.keyframes) {
    check_keyframes(keyframes_, "device");
  }
  HandleSample sample(double t) override { return sample_keyframes(keyframes_, t); }
  std::function<HandleSample(double)> path() const override {
    return [keyframes = keyframes_](double t) { return sample_keyframes(keyframes, t); };
  }

 private:
  std::vector<KeyframeSpec> keyframes_;
};

}  // namespace

std::unique_ptr<Handle> make_script(const DeviceSpec& spec) { return std::make_unique<ScriptHandle>(spec); }

}  // namespace palpate::device
