#include <fmt/format.h>

#include "palpate/contact/gpu_device.h"
#include "palpate/core/instructions.h"
#include "palpate/store/provenance.h"
#include "product/contact.h"

namespace palpate::bench {

ContactDevice device_of(const std::string& method) {
  if (method == "image") {
    const contact::GpuDevice device = contact::open_gpu();
    return {fmt::format("{}, {}", device.name, device.driver), device.software};
  }
  return {fmt::format("{}, {}", store::provenance().cpu, name_of(best_instructions())), false};
}

}  // namespace palpate::bench
