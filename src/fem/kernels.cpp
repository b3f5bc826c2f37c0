#include <cstdlib>
#include <string_view>

#include "fem/lane_kernels.h"
#include "palpate/core/error.h"

namespace palpate::fem {

namespace baseline {
extern const LaneKernels kernels;
}
#ifdef PALPATE_X86_KERNELS
namespace avx2 {
extern const LaneKernels kernels;
}
namespace avx512 {
extern const LaneKernels kernels;
}
#endif

const LaneKernels* find_kernels(const char* name) {
  const std::string_view wanted(name);
#ifdef PALPATE_X86_KERNELS
  __builtin_cpu_init();
  if (wanted == "avx512" && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma"))
    return &avx512::kernels;
  if (wanted == "avx2" && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    return &avx2::kernels;
#endif
  return wanted == "baseline" ? &baseline::kernels : nullptr;
}

const LaneKernels& best_kernels() {
  if (const char* wanted = std::getenv("PALPATE_INSTRUCTIONS"); wanted != nullptr && *wanted != '\0') {
    const LaneKernels* kernels = find_kernels(wanted);
    if (kernels == nullptr)
      fail(
          "PALPATE_INSTRUCTIONS = \"{}\": this build or this processor does not have it; baseline, avx2 and "
          "avx512 exist",
          wanted);
    return *kernels;
  }
  for (const char* name : {"avx512", "avx2"})
    if (const LaneKernels* kernels = find_kernels(name)) return *kernels;
  return baseline::kernels;
}

}  // namespace palpate::fem
