#include "tune.h"

#include <unistd.h>

#include <cstdlib>

// OpenBLAS 0.3.21 knows CPUs by family and model, and falls back to old kernels on those that came after it.
// CPU features do not lie. CHOLMOD's supernodal code starts four OpenMP threads for copies of a few
// kilobytes, whatever OMP_NUM_THREADS says; only the thread limit stops it.  More BLAS threads do not help
// our matrices (some ten thousand rows).  All of this is read while the libraries load.
//
// One numeric factorisation of 11,100 rows (palpate bench fem; two cores with AVX-512): 30 ms as set here; 46
// ms with the kernels that an unknown CPU gets; 62 ms without the thread limit; 33 ms with two BLAS threads;
// 64 ms with nothing set.  The restart costs 20 ms.

namespace palpate::cli {
namespace {

/// True when the variable was unset and is now set.
bool provide(const char* name, const char* value) {
  return value && !std::getenv(name) && ::setenv(name, value, 0) == 0;
}

}  // namespace

const char* openblas_core_type() {
#if defined(__x86_64__) && defined(__GNUC__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512cd"))
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
