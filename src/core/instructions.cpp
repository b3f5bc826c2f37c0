#include "palpate/core/instructions.h"

#include <cstdlib>

#include "palpate/core/error.h"

namespace palpate {

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
  for (const Instructions known : {Instructions::kBaseline, Instructions::kAvx2, Instructions::kAvx512})
    if (name == name_of(known)) {
      set = known;
      return has_instructions(set);
    }
  return false;
}

Instructions best_instructions() {
  if (const char* wanted = std::getenv("PALPATE_INSTRUCTIONS"); wanted != nullptr && *wanted != '\0') {
    Instructions set;
    if (!find_instructions(wanted, set))
      fail(
          "PALPATE_INSTRUCTIONS = \"{}\": this build or this processor does not have it; baseline, avx2 and "
          "avx512 exist",
          wanted);
    return set;
  }
  for (const Instructions set : {Instructions::kAvx512, Instructions::kAvx2})
    if (has_instructions(set)) return set;
  return Instructions::kBaseline;
}

}  // namespace palpate
