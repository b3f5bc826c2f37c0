#include "linear/direct/blas_memory.h"

#include <dlfcn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <mutex>

#include "core/memory.h"
#include "palpate/core/error.h"

namespace palpate::linear {
namespace {

/// Fortran BLAS dgemm: C = alpha A B + beta C.
using Dgemm = void (*)(const char*, const char*, const int*, const int*, const int*, const double*,
                       const double*, const int*, const double*, const int*, const double*, double*,
                       const int*);

/// Computes one small product, larger than a BLAS computes without its buffer.
void multiply(Dgemm dgemm) {
  constexpr int n = 64;
  static std::array<double, n * n> a{}, b{}, c{};
  const double one = 1.0;
  dgemm("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &one, c.data(), &n);
}

/// Body of the child process: the product takes microseconds; a BLAS that waits for memory is ended by the
/// limits on its time (1 s of CPU, kLongestWait of wall time).
[[noreturn]] void try_product(Dgemm dgemm) {
  const rlimit no_core{0, 0}, one_second{1, 1};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &one_second);
  constexpr unsigned kLongestWait = 60;
  for (const int signal : {SIGALRM, SIGXCPU, SIGSEGV, SIGABRT}) std::signal(signal, SIG_DFL);
  ::alarm(kLongestWait);
  multiply(dgemm);
  ::_exit(0);
}

/// Whether a product by this BLAS returns, tried in a child process.
bool dgemm_returns(Dgemm dgemm) {
  const pid_t child = ::fork();
  if (child == 0) try_product(dgemm);
  if (child < 0) return true;  // fork failed: assume that it does
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Runs a first product, so that the BLAS allocates its buffers; see reserve_blas_memory().
void reserve() {
  const auto dgemm = reinterpret_cast<Dgemm>(::dlsym(RTLD_DEFAULT, "dgemm_"));
  if (!dgemm) return;  // a BLAS with other symbol names
  if (addresses_are_limited() && !dgemm_returns(dgemm)) {
    const AvailableMemory left = available_memory();
    fail(
        "the BLAS cannot allocate its working memory: OpenBLAS needs about 128 MiB of address space, and {} "
        "are left ({}). Raise the limit, or set integrator.linear_solver = \"pcg-single\", which does not "
        "need the BLAS",
        memory_text(left.bytes), left.limited_by);
  }
  multiply(dgemm);
}

}  // namespace

void reserve_blas_memory() {
  static std::once_flag once;
  std::call_once(once, reserve);
}

void refuse_factor_beyond_memory(double unknowns, double bytes) {
  refuse_beyond_memory(fmt::format("the entries of the factor of {:.0f} unknowns", unknowns), bytes, "",
                       "a coarser mesh or integrator.linear_solver = \"pcg-single\" needs less");
}

void fail_without_memory(const char* call, double unknowns) {
  const AvailableMemory left = available_memory();
  fail(
      "{}: no memory for the factor of {:.0f} unknowns: {} are left ({}); use a coarser mesh, or "
      "integrator.linear_solver = \"pcg-single\"",
      call, unknowns, memory_text(left.bytes), left.limited_by);
}

}  // namespace palpate::linear
