#include "core/instructions.h"
#include "fem/lane_kernels.h"
#include "fem/law_list.h"

namespace palpate::fem {

#define PALPATE_DECLARE_KERNELS(name) extern const LawKernels name;
#define PALPATE_ADDRESS(name) &name,
#define PALPATE_SET(set)                                                 \
  namespace set {                                                        \
  extern const SharedKernels shared;                                     \
  PALPATE_LAWS(PALPATE_DECLARE_KERNELS)                                  \
  constexpr const LawKernels* kLaws[] = {PALPATE_LAWS(PALPATE_ADDRESS)}; \
  constexpr LaneKernels kKernels{#set, &shared, kLaws};                  \
  }

PALPATE_SET(baseline)
#ifdef PALPATE_X86_KERNELS
PALPATE_SET(avx2)
PALPATE_SET(avx512)
#endif

namespace {

const LaneKernels* kernels_of(Instructions set) {
#ifdef PALPATE_X86_KERNELS
  if (set == Instructions::kAvx512) return &avx512::kKernels;
  if (set == Instructions::kAvx2) return &avx2::kKernels;
#else
  static_cast<void>(set);
#endif
  return &baseline::kKernels;
}

}  // namespace

const LaneKernels* find_kernels(const char* name) {
  Instructions set;
  return find_instructions(name, set) ? kernels_of(set) : nullptr;
}

const LaneKernels& best_kernels() { return *kernels_of(best_instructions()); }

}  // namespace palpate::fem
