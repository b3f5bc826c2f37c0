#pragma once
#include <string>

namespace palpate::experiments {

/// Outcome of a task.
enum class Status {
  kOk,
  kFailed,     ///< The computation failed: an integrator that did not converge, a state that is not finite.
  kRefused,    ///< The scene or the integrator cannot run with these settings.
  kOutOfTime,  ///< The limit of its CPU time was reached.
  kCrashed,    ///< Its process ended without a result.
  kNotTried,   ///< It was skipped, because of the result of another task.
  /// It has not run, or its process was killed from outside or ran out of memory.  Never stored.
  kMissing,
};
inline constexpr int kStatuses = 7;  ///< Number of values of Status.

/// Returns the name for tables and files: "ok", "out of time".
const char* to_string(Status status);
/// Returns the status of a name; kMissing for an unknown one.
Status status_of(const std::string& name);

}  // namespace palpate::experiments
