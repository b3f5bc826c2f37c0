#include "core/instructions.h"

#include <cstdlib>

#include "palpate/core/error.h"

namespace palpate {
namespace {
constexpr Instructions kAll[] = {Instructions::kBaseline, Instructions::kAvx2, Instructions::kAvx512};
}

bool has_instructions(Instructions set) {
  if (set == Instructions::kBaseline) return true;
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return false;
  return set == Instructions::kAvx2 ||
         (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
          __builtin_cpu_supports("avx512vl"));
#else
  return false;
#endif
}

bool find_instructions(std::string_view name, Instructions& set) {
  const auto known = value_named<Instructions>(name);
  if (known) set = *known;
  return known && has_instructions(set);
}

Instructions choose_instructions(std::string_view requested, Instructions widest) {
  if (requested.empty()) return widest;
  std::string there;
  for (const Instructions known : kAll) {
    if (known > widest) break;
    if (requested == name_of(known)) return known;
    there += fmt::format("{}{}", there.empty() ? "" : ", ", name_of(known));
  }
  fail(
      "PALPATE_INSTRUCTIONS = \"{}\": {}; set it to one of {}, or unset it", requested,
      value_named<Instructions>(requested) ? "this processor does not support it" : "unknown instruction set",
      there);
}

Instructions best_instructions() {
  Instructions widest = Instructions::kBaseline;
  for (const Instructions set : kAll)
    if (has_instructions(set)) widest = set;
  const char* requested = std::getenv("PALPATE_INSTRUCTIONS");
  return choose_instructions(requested ? requested : "", widest);
}

}  // namespace palpate
