#include "tune.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

// OpenBLAS 0.3.21 selects kernels by CPU family and model, and falls back to old kernels on later CPUs; CPU
// feature flags are reliable. The supernodal code of CHOLMOD starts four OpenMP threads for copies of a few
// kilobytes, whatever the value of OMP_NUM_THREADS; only the thread limit prevents it. More BLAS threads do
// not speed up the matrices here (some ten thousand rows). All of these settings are read while the libraries
// load.
//
// One numeric factorisation of 11,100 rows (palpate bench fem; two cores with AVX-512): 30 ms as set here; 46
// ms with the kernels for an unknown CPU; 62 ms without the thread limit; 33 ms with two BLAS threads; 64 ms
// with nothing set. The restart costs 20 ms.
//
// If the address space is limited (ulimit -v, ulimit -d), the restart precedes the initialisation of all
// libraries. OpenBLAS starts its threads while it is loaded; each reserves 128 MiB of addresses and retries
// forever if the reservation fails, and the program waits for the threads at its end: below 220 MiB `palpate
// list integrators` did not return. Without further threads, version 0.3.21 reserves memory when a matrix is
// factorised, and is then refused (blas_memory.cpp); version 0.3.29 reserves it while it is loaded, also
// retrying forever. A child process therefore loads the libraries first, under a time limit.

namespace palpate::cli {
namespace {

/// Sets a variable unless it is set; returns whether it was set here.
bool provide(const char* name, const char* value) {
  return value && !std::getenv(name) && ::setenv(name, value, 0) == 0;
}

bool is_limited(__rlimit_resource_t resource) {
  rlimit most{};
  return ::getrlimit(resource, &most) == 0 && most.rlim_cur != RLIM_INFINITY;
}

constexpr char kLoad[] = "PALPATE_LIBRARIES_LOAD";

/// Returns whether the libraries load with that environment, tested in a child process that ends after
/// loading (end_where_loading_is_tried). Loading takes about 30 ms.
bool libraries_load(char** argv, char** envp) {
  const pid_t child = ::fork();
  if (child < 0) return true;  // no process available: the libraries may load all the same
  if (child == 0) {
    const rlimit no_core{0, 0}, one_second{1, 1};
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::setrlimit(RLIMIT_CPU, &one_second);
    constexpr unsigned kLongestWait = 60;
    ::alarm(kLongestWait);
    ::execve("/proc/self/exe", argv, envp);
    ::_exit(0);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  return WIFEXITED(status);
}

[[noreturn]] void end_without_libraries() {
  const auto mib = [](__rlimit_resource_t resource) {
    rlimit most{};
    return ::getrlimit(resource, &most) == 0 && most.rlim_cur != RLIM_INFINITY
               ? static_cast<double>(most.rlim_cur) / (1024.0 * 1024.0)
               : HUGE_VAL;
  };
  std::array<char, 256> text{};
  const int size =
      std::snprintf(text.data(), text.size(),
                    "palpate: error: the libraries cannot be loaded within %.0f MiB of address space (ulimit "
                    "-v, ulimit -d); OpenBLAS alone needs 128 MiB. Raise the limit\n",
                    std::min(mib(RLIMIT_AS), mib(RLIMIT_DATA)));
  const ssize_t written = ::write(STDERR_FILENO, text.data(), static_cast<std::size_t>(std::max(size, 0)));
  ::_exit(written < 0 ? 3 : 1);
}

/// Restarts the program with one BLAS thread if the address space is limited. Runs before the constructors of
/// all libraries, including the C library, so that the environment is passed as an argument.
void restart_where_limited(int /*argc*/, char** argv, char** envp) {
  constexpr char kThreads[] = "OPENBLAS_NUM_THREADS=";
  if (!is_limited(RLIMIT_AS) && !is_limited(RLIMIT_DATA)) return;
  const auto begins = [](const char* text, const char* with) {
    return std::strncmp(text, with, std::strlen(with)) == 0;
  };
  bool has_threads = false;
  std::size_t count = 0;
  for (; envp[count]; ++count) {
    if (begins(envp[count], kLoad)) return;
    has_threads = has_threads || begins(envp[count], kThreads);
  }
  auto** const changed = static_cast<char**>(std::calloc(count + 3, sizeof(char*)));
  if (!changed) return;
  static char one_thread[] = "OPENBLAS_NUM_THREADS=1", tried[] = "PALPATE_LIBRARIES_LOAD=try",
              known[] = "PALPATE_LIBRARIES_LOAD=yes";
  std::memcpy(changed, envp, count * sizeof(char*));
  changed[count] = tried;
  if (!has_threads) changed[count + 1] = one_thread;
  if (!libraries_load(argv, changed)) end_without_libraries();
  changed[count] = known;
  ::execve("/proc/self/exe", argv, changed);
  std::free(changed);
}

#ifndef __SANITIZE_ADDRESS__  // the functions of the sanitizer are not ready at that time
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)(int, char**,
                                                                             char**) = restart_where_limited;
#endif

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

void end_where_loading_is_tried() {
  if (const char* load = std::getenv(kLoad); load && std::strcmp(load, "try") == 0) ::_exit(0);
}

void restart_tuned(char** argv) {
  bool changed = provide("OPENBLAS_CORETYPE", openblas_core_type());
  changed |= provide("OPENBLAS_NUM_THREADS", "1");
  changed |= provide("OMP_THREAD_LIMIT", "1");
  if (changed) ::execv("/proc/self/exe", argv);
}

}  // namespace palpate::cli
