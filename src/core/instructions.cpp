#include "core/instructions.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include "palpate/core/error.h"

namespace palpate {
namespace {
constexpr Instructions kAll[] = {Instructions::kBaseline, Instructions::kAvx2, Instructions::kAvx512};
}

std::string_view name_of(Instructions set) {
  switch (set) {
    case Instructions::kBaseline: return "baseline";
    case Instructions::kAvx2: return "avx2";
    case Instructions::kAvx512: return "avx512";
  }
  return {};
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
  for (const Instructions known : kAll)
    if (name == name_of(known)) {
      set = known;
      return has_instructions(set);
    }
  return false;
}

Instructions choose_instructions(std::string_view requested, Instructions widest) {
  if (requested.empty()) return widest;
  std::string there;
  for (const Instructions known : kAll) {
    if (known > widest) break;
    if (requested == name_of(known)) return known;
    there += fmt::format("{}{}", there.empty() ? "" : ", ", name_of(known));
  }
  const bool exists = std::any_of(std::begin(kAll), std::end(kAll),
                                  [&](Instructions known) { return requested == name_of(known); });
  fail("PALPATE_INSTRUCTIONS = \"{}\": {}; set it to one of {}, or unset it", requested,
       exists ? "this processor does not support it" : "unknown instruction set", there);
}

Instructions best_instructions() {
  Instructions widest = Instructions::kBaseline;
  for (const Instructions set : kAll)
    if (has_instructions(set)) widest = set;
  const char* requested = std::getenv("PALPATE_INSTRUCTIONS");
  return choose_instructions(requested ? requested : "", widest);
}

}  // namespace palpate
