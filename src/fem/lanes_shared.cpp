// Kernels that do not depend on the constitutive law.
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "fem/lane_kernels.h"

namespace palpate::fem::PALPATE_KERNELS {
namespace {

#include "fem/lanes.h"

#include "fem/lane_element.h"

#include "fem/lane_flush.h"

#include "fem/lane_deferred.h"

static void power(const ElementGroup* groups, int count, const ElementModel& model, const ChunkFields& fields,
                  double sums[8]) {
  for (int g = 0; g < count; ++g) {
    fetch_ahead(groups, g);
    for (int part = 0; part < 8; part += kWidth) {
      const Lanes at{groups[g], part, g};
      const Gradients G = gradients(at);
      const Symmetric rate = symmetric_product(gradient_of(at, G, fields.x), gradient_of(at, G, fields.v));
      *reinterpret_cast<PackInMemory*>(sums + part) +=
          at.volume() * double_dot(full(rate), full(damping_stress(rate, model)));
    }
  }
}

}  // namespace

extern const SharedKernels shared;
const SharedKernels shared{flush, scatter, power};

}  // namespace palpate::fem::PALPATE_KERNELS
