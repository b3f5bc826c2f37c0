#include <fmt/format.h>

#include "palpate/bench/contact.h"
#include "palpate/contact/gpu_available.h"
#include "palpate/core/instructions.h"
#include "palpate/store/provenance.h"

namespace palpate::bench {

ContactDevice device_of(std::string_view method) {
  if (method == "gpu") {
    const contact::GpuDevice gpu = contact::gpu_device();
    return {.name = gpu.name, .driver = gpu.driver, .instructions = {}};
  }
  // exact lines have no lanes
  return {.name = store::provenance().cpu,
          .driver = {},
          .instructions = method == "cpu" ? std::string(name_of(best_instructions())) : std::string()};
}

std::string in_words(const ContactDevice& device) {
  if (device.name.empty()) return "none";
  std::string out = device.name;
  for (const std::string& more : {device.driver, device.instructions})
    if (!more.empty()) out += ", " + more;
  return out;
}

}  // namespace palpate::bench
