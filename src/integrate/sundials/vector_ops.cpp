#include "integrate/sundials/vector_ops.h"

#include <nvector/nvector_serial.h>

#include <cmath>

#include "palpate/core/types.h"

namespace palpate::integrate::sun {
namespace {

using Array = Eigen::Map<Eigen::ArrayXd>;

Array array(N_Vector v) { return {NV_DATA_S(v), static_cast<Eigen::Index>(NV_LENGTH_S(v))}; }

sunrealtype weighted_rms_norm(N_Vector x, N_Vector w) {
  return std::sqrt((array(x) * array(w)).square().sum() / static_cast<double>(NV_LENGTH_S(x)));
}

// Every operation is entry by entry, so z may be x or y.
void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z) {
  array(z) = a * array(x) + b * array(y);
}

void scale(sunrealtype c, N_Vector x, N_Vector z) { array(z) = c * array(x); }

void set_constant(sunrealtype c, N_Vector z) { array(z) = c; }

int linear_combination(int count, sunrealtype* c, N_Vector* x, N_Vector z) {
  if (count == 1) scale(c[0], x[0], z);
  if (count < 2) return 0;
  // z may be the first vector only: the pair that contains it is processed first.
  linear_sum(c[0], x[0], c[1], x[1], z);
  for (int i = 2; i < count; ++i) array(z) += c[i] * array(x[i]);
  return 0;
}

}  // namespace

void use_fast_operations(N_Vector v) {
  v->ops->nvwrmsnorm = weighted_rms_norm;
  v->ops->nvlinearsum = linear_sum;
  v->ops->nvscale = scale;
  v->ops->nvconst = set_constant;
  v->ops->nvlinearcombination = linear_combination;
}

int index_of_largest(N_Vector v, N_Vector w) {
  Eigen::Index at = -1;
  const double largest = (array(v) * array(w)).abs().maxCoeff(&at);
  return largest > 0.0 ? static_cast<int>(at) : -1;
}

}  // namespace palpate::integrate::sun
