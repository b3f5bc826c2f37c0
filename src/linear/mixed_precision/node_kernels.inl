// The kernels of node_kernels.h for one instruction set: PALPATE_SET is its name, PALPATE_LANES its width in
// floats (4, 8, 16). This file must not call library functions: an inline function compiled for this set
// could be linked into code for another.

#include "linear/mixed_precision/node_kernels.h"

namespace palpate::linear {
namespace {
namespace PALPATE_SET {

#define PALPATE_INLINE [[gnu::always_inline]] static inline
#define PALPATE_INLINE_MEMBER [[gnu::always_inline]] inline

// Each file uses the ones before it.
// clang-format off
#include "linear/mixed_precision/node_lanes.inl"
#include "linear/mixed_precision/node_products.inl"
#include "linear/mixed_precision/node_iteration.inl"
#include "linear/mixed_precision/node_columns.inl"
#include "linear/mixed_precision/node_doubles.inl"
#include "linear/mixed_precision/node_starts.inl"
// clang-format on

#undef PALPATE_INLINE
#undef PALPATE_INLINE_MEMBER

}  // namespace PALPATE_SET
}  // namespace
}  // namespace palpate::linear

// clang-format off
#define PALPATE_KERNELS_OF(set)                                                                        \
  {#set, set::product, set::pack, set::complete, set::multiply, set::multiply_zero_row_sum, set::update,    \
   set::jacobi, set::gather_rigid, set::direction, set::first_direction, set::dense, set::invert,      \
   set::inner_products, set::add_columns,                                                              \
   set::convert, set::multiply_double, set::gram, set::combine, set::leave, set::difference,           \
   set::residual, set::image, set::correct, set::scatter_nodes, set::add_nodes, set::invert_diagonal}
// clang-format on
