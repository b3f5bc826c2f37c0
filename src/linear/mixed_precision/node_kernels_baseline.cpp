// The kernels of node_kernels.h for any x86-64 processor, four single-precision lanes.
#define PALPATE_SET baseline
#define PALPATE_LANES 4
#include "linear/mixed_precision/node_kernels.inl"

namespace palpate::linear {
extern const NodeKernels kNodeKernels_baseline;
const NodeKernels kNodeKernels_baseline = PALPATE_KERNELS_OF(baseline);
}  // namespace palpate::linear
