#include "contact/face_kernels.h"

#include "palpate/core/instructions.h"

namespace palpate::contact {

namespace baseline {
extern const FaceKernels kFaces;
}
#ifdef PALPATE_X86_KERNELS
namespace avx2 {
extern const FaceKernels kFaces;
}
namespace avx512 {
extern const FaceKernels kFaces;
}
#endif

const FaceKernels& best_face_kernels() {
#ifdef PALPATE_X86_KERNELS
  const Instructions set = best_instructions();
  if (set == Instructions::kAvx512) return avx512::kFaces;
  if (set == Instructions::kAvx2) return avx2::kFaces;
#endif
  return baseline::kFaces;
}

}  // namespace palpate::contact
