#include "device/make.h"

namespace palpate::device {

const Registry<MakeHandle>& handle_registry() {
  static const Registry<MakeHandle> registry = {
      {"script",
       "follows the keyframes of the scene",
       0,
       make_script,
       {{.name = "keyframe", .required = true}}},
  };
  return registry;
}

std::unique_ptr<Handle> make_handle(const DeviceSpec& spec) {
  return find(handle_registry(), spec.type, "device type").make(spec);
}

}  // namespace palpate::device
