#pragma once
#include <array>
#include <string_view>

#include "palpate/core/named_enum.h"

/// Instruction sets that kernels are compiled for; the one in use is chosen at run time.
namespace palpate {

/// Instruction sets in ascending order of width.
enum class Instructions { kBaseline, kAvx2, kAvx512 };
/// Returns the names of the values.
constexpr std::array<std::string_view, 3> option_names(Instructions) {
  return {"baseline", "avx2", "avx512"};
}

/// Whether this processor supports the set.
bool has_instructions(Instructions set);
/// Finds a set by name.  @param name  "baseline", "avx2" or "avx512"  @return whether the set exists and this
/// processor supports it
bool find_instructions(std::string_view name, Instructions& set);
/// Returns the requested set.
/// @param requested  name of a set, or empty for `widest`
/// @param widest  widest set that the processor supports; it supports all narrower ones
/// @throws Error for an unknown name, and for a set wider than `widest`
Instructions choose_instructions(std::string_view requested, Instructions widest);
/// Returns the widest set that this processor supports, or the one that the environment variable
/// PALPATE_INSTRUCTIONS specifies.  @throws Error when that one is unknown or unsupported
Instructions best_instructions();

}  // namespace palpate
