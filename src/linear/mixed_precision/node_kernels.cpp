#include "linear/mixed_precision/node_kernels.h"

namespace palpate::linear {

extern const NodeKernels kNodeKernels_baseline;
#if defined(PALPATE_X86_KERNELS)
extern const NodeKernels kNodeKernels_avx2, kNodeKernels_avx512;
#endif

const NodeKernels& node_kernels(int limit) {
#if defined(PALPATE_X86_KERNELS)
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (limit >= 2 && avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq"))
    return kNodeKernels_avx512;
  if (limit >= 1 && avx2) return kNodeKernels_avx2;
#else
  static_cast<void>(limit);
#endif
  return kNodeKernels_baseline;
}

}  // namespace palpate::linear
