#include "tune.h"

#include <unistd.h>

#include <cstdlib>

// OpenBLAS 0.3.21 knows CPUs by family and model, and falls back to old kernels on those that came after it: on a CPU with AVX-512 that
// it does not know, dgemm is 2 to 4 times slower.  CPU features do not lie.
// CHOLMOD's supernodal code starts four OpenMP threads for copies of a few kilobytes, whatever OMP_NUM_THREADS says; only the thread limit
// stops it.  More BLAS threads make our matrices (a few ten thousand rows) slower, and would make sums depend on their number.

namespace palpate::cli {
namespace {

/// True when the variable was unset and is now set.
bool provide(const char* name, const char* value) { return value && !std::getenv(name) && ::setenv(name, value, 0) == 0; }

}  // namespace

const char* openblas_core_type() {
#if defined(__x86_64__) && defined(__GNUC__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd"))
    return "SKYLAKEX";
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "HASWELL";
#endif
  return nullptr;
}

void restart_tuned(char** argv) {
  bool changed = provide("OPENBLAS_CORETYPE", openblas_core_type());
  changed |= provide("OPENBLAS_NUM_THREADS", "1");
  changed |= provide("OMP_THREAD_LIMIT", "1");
  if (changed) ::execv("/proc/self/exe", argv);
}

}  // namespace palpate::cli
