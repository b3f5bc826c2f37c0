#define PALPATE_SET avx512
#define PALPATE_LANES 16
#include "integrate/linear/node_kernels.inl"

namespace palpate::integrate {
extern const NodeKernels kNodeKernels_avx512;
const NodeKernels kNodeKernels_avx512 = PALPATE_KERNELS_OF(avx512);
}  // namespace palpate::integrate
