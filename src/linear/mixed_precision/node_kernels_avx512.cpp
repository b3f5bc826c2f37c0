// The kernels of node_kernels.h for AVX-512, sixteen single-precision lanes.
#define PALPATE_SET avx512
#define PALPATE_LANES 16
#include "linear/mixed_precision/node_kernels.inl"

namespace palpate::linear {
extern const NodeKernels kNodeKernels_avx512;
const NodeKernels kNodeKernels_avx512 = PALPATE_KERNELS_OF(avx512);
}  // namespace palpate::linear
