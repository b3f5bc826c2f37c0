#pragma once
#include <sys/types.h>

#include <cstdint>
#include <string>

#include "core/process_pool.h"

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
  ProcessPool::Work work;
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

// --- socket_message.cpp: whole messages over a stream; false where the other side is gone

bool send_bytes(int socket, const void* data, std::size_t size);
bool receive_bytes(int socket, void* data, std::size_t size);
/// Sends `size` > 0 bytes and an open file descriptor.
bool send_with_file(int socket, const void* data, std::size_t size, int file);
/// Receives `size` bytes.  @param file  file descriptor that was passed along, or -1
bool receive_with_file(int socket, void* data, std::size_t size, int& file);

// --- work_process.cpp

/// Runs the work in its process and sends the outcome into the pipe; never returns.
/// @param server  process that it must not outlive
[[noreturn]] void run_work(const Request& request, const std::string& folder, const std::string& input,
                           int pipe, pid_t server);
/// First byte that run_work sends: a result follows, or an exception's message.
inline constexpr char kGood = 'g', kBad = 'b', kNoMemory = 'm';

}  // namespace palpate::work_server
