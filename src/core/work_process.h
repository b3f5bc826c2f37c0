#pragma once
#include <sys/types.h>

#include <atomic>
#include <string>

namespace palpate::work_server {

/// Function that a process runs; see ProcessPool::Work.
using Work = std::string (*)(const std::string& bytes, const std::atomic<bool>& out_of_time);

/// Runs the work in its process and sends the outcome into the pipe; never returns.
/// @param limit_s  CPU seconds until `out_of_time`
/// @param folder  working folder
/// @param server  process that it must not outlive
[[noreturn]] void run_work(Work work, double limit_s, const std::string& folder, const std::string& input,
                           int pipe, pid_t server);
/// First byte that run_work sends: a result follows, an exception's message, or that of exhausted memory.
inline constexpr char kGood = 'g', kBad = 'b', kNoMemory = 'm';

}  // namespace palpate::work_server
