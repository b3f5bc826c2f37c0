#define PALPATE_SET baseline
#define PALPATE_LANES 4
#include "integrate/linear/node_kernels.inl"

namespace palpate::integrate {
extern const NodeKernels kNodeKernels_baseline;
const NodeKernels kNodeKernels_baseline = PALPATE_KERNELS_OF(baseline);
}  // namespace palpate::integrate
