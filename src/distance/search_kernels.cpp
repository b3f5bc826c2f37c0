#include "distance/search_kernels.h"

#include "core/instructions.h"

namespace palpate::distance {

namespace baseline {
extern const SearchKernels kSearch;
}
#ifdef PALPATE_X86_KERNELS
namespace avx2 {
extern const SearchKernels kSearch;
}
namespace avx512 {
extern const SearchKernels kSearch;
}
#endif

const SearchKernels& best_search_kernels() {
#ifdef PALPATE_X86_KERNELS
  const Instructions set = best_instructions();
  if (set == Instructions::kAvx512) return avx512::kSearch;
  if (set == Instructions::kAvx2) return avx2::kSearch;
#endif
  return baseline::kSearch;
}

}  // namespace palpate::distance
