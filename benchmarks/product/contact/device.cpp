#include <fmt/format.h>

#include "contact/gpu_device.h"
#include "core/instructions.h"
#include "product/contact.h"
#include "store/provenance.h"

namespace palpate::bench {

ContactDevice device_of(const std::string& method) {
  if (method == "image") {
    const contact::GpuDevice device = contact::open_gpu();
    return {fmt::format("{}, {}", device.name, device.driver), device.software};
  }
  return {fmt::format("{}, {}", store::provenance().cpu, name_of(best_instructions())), false};
}

}  // namespace palpate::bench
