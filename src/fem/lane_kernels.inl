// The element kernels in lanes.  A file that includes this one names the instruction set by PALPATE_KERNELS
// (a namespace), PALPATE_NAME (its name) and PALPATE_WIDTH (doubles in a vector).  No other header with
// inline code may come in here: see lane_kernels.h.
#include "fem/lane_kernels.h"

namespace palpate::fem::PALPATE_KERNELS {
namespace {

#include "fem/lanes.h"

#include "fem/lane_rotation.h"

#include "fem/lane_element.h"

#include "fem/lane_flush.h"

#include "fem/lane_blocks.h"

}  // namespace

extern const LaneKernels kernels;
const LaneKernels kernels{PALPATE_NAME, force, apply_tangent, tangent, flush,
                          step_force,   step,  leave,         energy,  power};

}  // namespace palpate::fem::PALPATE_KERNELS
