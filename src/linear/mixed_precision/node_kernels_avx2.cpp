// The kernels of node_kernels.h for AVX2, eight single-precision lanes.
#define PALPATE_SET avx2
#define PALPATE_LANES 8
#include "linear/mixed_precision/node_kernels.inl"

namespace palpate::linear {
extern const NodeKernels kNodeKernels_avx2;
const NodeKernels kNodeKernels_avx2 = PALPATE_KERNELS_OF(avx2);
}  // namespace palpate::linear
