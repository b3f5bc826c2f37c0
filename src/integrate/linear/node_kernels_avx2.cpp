#define PALPATE_SET avx2
#define PALPATE_LANES 8
#include "integrate/linear/node_kernels.inl"

namespace palpate::integrate {
extern const NodeKernels kNodeKernels_avx2;
const NodeKernels kNodeKernels_avx2 = PALPATE_KERNELS_OF(avx2);
}  // namespace palpate::integrate
