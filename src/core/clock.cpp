#include "core/clock.h"

#include <dirent.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace palpate {
namespace {
double seconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}
}  // namespace

double wall_seconds() { return seconds(CLOCK_MONOTONIC); }
// While a process has a timer or a limit on its CPU time (core/process_pool.h sets both), Linux updates
// CLOCK_PROCESS_CPUTIME_ID at scheduler ticks only: a run of a millisecond then took 0 s.  The clocks of its
// threads stay exact.  Their clock id is (~tid << 3) | 6, as pthread_getcpuclockid() computes it:
// CPUCLOCK_PERTHREAD_MASK | CPUCLOCK_SCHED.
double cpu_seconds() {
  DIR* tasks = opendir("/proc/self/task");
  if (!tasks) return seconds(CLOCK_PROCESS_CPUTIME_ID);
  double sum = 0.0;
  while (const dirent* task = readdir(tasks))
    if (const int tid = std::atoi(task->d_name); tid > 0)
      sum += seconds(static_cast<clockid_t>((~static_cast<unsigned>(tid) << 3) | 6u));
  closedir(tasks);
  return sum;
}
double thread_cpu_seconds() { return seconds(CLOCK_THREAD_CPUTIME_ID); }

// Linux passes ru_maxrss on to the program that a process becomes by exec: a small run started by a large
// program would report the peak of the latter.  VmHWM refers to this program's memory only.
double peak_memory_mib() {
  long kib = 0;
  if (std::FILE* f = std::fopen("/proc/self/status", "r")) {
    for (char line[256]; kib == 0 && std::fgets(line, sizeof line, f);) std::sscanf(line, "VmHWM: %ld", &kib);
    std::fclose(f);
  }
  if (kib > 0) return static_cast<double>(kib) / 1024.0;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

double resident_memory_mib() {
  long pages = 0, resident = 0;
  if (std::FILE* f = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(f, "%ld %ld", &pages, &resident) != 2) resident = 0;
    std::fclose(f);
  }
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

}  // namespace palpate
