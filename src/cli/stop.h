#pragma once
#include <atomic>

namespace palpate::cli {

/// Returns the flag that the first Ctrl-C, SIGTERM or SIGHUP sets. Loops poll it and end cleanly, with zero
/// wrench on the hand. A second Ctrl-C ends the program at once.
const std::atomic<bool>& stop_flag();
void catch_stop_signals();  ///< Installs the signal handlers

/// Invalid input, failed integration, or a failed case with a known answer
inline constexpr int kExitError = 1;
inline constexpr int kExitInternalError = 2;  ///< Defect of palpate
/// An output of the command is missing, everything else succeeded; the last line reports which
inline constexpr int kExitIncomplete = 3;
inline constexpr int kExitStopped = 130;  ///< Ended by Ctrl-C; the value that shells report

}  // namespace palpate::cli
