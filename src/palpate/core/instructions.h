#pragma once
#include <string_view>

/// Instruction sets that kernels are compiled for; which one is used is chosen at run time.
namespace palpate {

enum class Instructions { kBaseline, kAvx2, kAvx512 };

std::string_view name_of(Instructions set);  ///< "baseline", "avx2" or "avx512"
/// Whether this processor has it.
bool has_instructions(Instructions set);
/// @param name  "baseline", "avx2" or "avx512"  @return whether there is such a set and this processor has it
bool find_instructions(std::string_view name, Instructions& set);
/// @param wanted  a name, or empty: the widest  @param widest  that the processor has; it has all before it
/// @throws Error for another name, and for a set that is wider
Instructions choose_instructions(std::string_view wanted, Instructions widest);
/// The widest that this processor has; the environment variable PALPATE_INSTRUCTIONS may name another.
/// @throws Error when that is not to be had.
Instructions best_instructions();

}  // namespace palpate
