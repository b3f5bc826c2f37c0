#include <cstdlib>
#include <string_view>

#include "fem/lane_kernels.h"
#include "fem/law_list.h"
#include "palpate/core/error.h"

namespace palpate::fem {

#define PALPATE_LAW(name) extern const LawKernels name;
#define PALPATE_ADDRESS(name) &name,
#define PALPATE_SET(set)                                                 \
  namespace set {                                                        \
  extern const SharedKernels shared;                                     \
  PALPATE_LAWS(PALPATE_LAW)                                              \
  constexpr const LawKernels* kLaws[] = {PALPATE_LAWS(PALPATE_ADDRESS)}; \
  constexpr LaneKernels kKernels{#set, &shared, kLaws};                  \
  }

PALPATE_SET(baseline)
#ifdef PALPATE_X86_KERNELS
PALPATE_SET(avx2)
PALPATE_SET(avx512)
#endif

const LaneKernels* find_kernels(const char* name) {
  const std::string_view wanted(name);
#ifdef PALPATE_X86_KERNELS
  __builtin_cpu_init();
  if (wanted == "avx512" && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma"))
    return &avx512::kKernels;
  if (wanted == "avx2" && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    return &avx2::kKernels;
#endif
  return wanted == "baseline" ? &baseline::kKernels : nullptr;
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
  return baseline::kKernels;
}

}  // namespace palpate::fem
