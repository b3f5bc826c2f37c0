// Driver in C++ without motors, whose open throws.
#include <cstring>
#include <stdexcept>

#include "palpate/device/plugin.h"

namespace {

const char* specification(const char*, PalpatePluginSpecification* out) {
  std::strcpy(out->name, "throwing driver");
  return nullptr;
}
const char* open_device(const char* options, void** device) {
  if (std::strcmp(options, "throw") == 0) throw std::runtime_error("bus error 3");
  *device = nullptr;
  return nullptr;
}
const char* sample(void*, double, PalpatePluginSample* out) {
  out->rotation_wxyz[0] = 1.0;
  out->valid = 1;
  return nullptr;
}
void close_device(void*) {}

}  // namespace

PALPATE_DEVICE_PLUGIN(specification, open_device, sample, nullptr, close_device);
