#pragma once
#include <cstdint>

#include "work_process.h"

/// Helper that processes are forked from, seen from both sides of its sockets.
///
///   caller's process --(socket)--> helper          one per process; forks one server per pool, on request
///                    --(socket)--> server          one per pool; forks one process per job
///                    <--(pipe)---  process         result of the work
///
/// Each pool has a separate server, so pools are independent, whichever threads use them.  Each of these
/// processes ends when its socket closes or its parent dies, and ends those that it has started.
namespace palpate::work_server {

/// Request of a pool to its server.
struct Request {
  enum class Kind : std::uint32_t { kStart, kKill };
  Kind kind;
  std::uint64_t id;
  // For kStart alone; the bytes of folder and input follow, and the write end of the pipe is passed along.
  Work work;
  double limit_s;
  std::uint64_t folder_size, input_size;
};

/// Message of a server to its pool.
struct Notice {
  enum class Kind : std::uint32_t { kStarted, kNotStarted, kEnded };
  Kind kind;
  std::uint64_t id;
  std::int32_t value;  ///< kStarted: process id; kNotStarted: errno, or 0 for an unknown function; kEnded:
                       ///< waitpid() status.
};

/// Makes the helper, unless this process has one.  @throws Error where the process has other threads
void prepare();
/// Starts a new server.  @return the socket to it, which the caller closes
int connect();

}  // namespace palpate::work_server
