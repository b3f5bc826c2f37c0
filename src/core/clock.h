#pragma once

namespace palpate {

double wall_seconds();  ///< Monotonic wall clock [s].
double cpu_seconds();   ///< CPU time of this process, all living threads [s]; exact, costs some microseconds.
double thread_cpu_seconds();   ///< CPU time of the calling thread [s].
double peak_memory_mib();      ///< Largest resident set of this program so far [MiB].
double resident_memory_mib();  ///< Present resident set [MiB].

/// Adds the wall time of its lifetime to a sum [s].
class ScopedTimer {
 public:
  explicit ScopedTimer(double& sum) : sum_(sum), start_(wall_seconds()) {}
  ~ScopedTimer() { sum_ += wall_seconds() - start_; }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  double& sum_;
  double start_;
};

}  // namespace palpate
