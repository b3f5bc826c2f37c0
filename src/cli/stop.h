#pragma once
#include <atomic>

namespace palpate::cli {

/// Set by the first Ctrl-C, SIGTERM or SIGHUP: loops poll it and end cleanly, without a wrench on a hand.  A
/// second Ctrl-C ends the program at once.
const std::atomic<bool>& stop_flag();
void catch_stop_signals();

/// the input is at fault, the integrator gave up, or a case with a known answer failed
inline constexpr int kExitError = 1;
inline constexpr int kExitInternalError = 2;  ///< a defect of palpate
/// something that the command promises is missing, all else was done: the last line says what
inline constexpr int kExitIncomplete = 3;
inline constexpr int kExitStopped = 130;  ///< Ctrl-C, as shells report it

}  // namespace palpate::cli
