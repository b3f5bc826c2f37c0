#pragma once
#include <sys/types.h>

#include <cstdint>
#include <string>

#include "palpate/core/process_pool.h"

/// The helper that processes are forked from, seen from both sides of its sockets.
///
///   caller's process --(socket)--> helper          one a process; forks a server a pool, on request
///                    --(socket)--> server          one a pool; forks a process a piece of work
///                    <--(pipe)---  process         what the work returned
///
/// Each pool has a server of its own, which makes it independent of all others, whichever threads they are
/// used from.  Each of these processes ends when its socket closes or its parent dies, and ends those that it
/// has started.
namespace palpate::work_server {

/// Request of a pool to its server.
struct Request {
  enum class Kind : std::uint32_t { kStart, kKill };
  Kind kind;
  std::uint64_t id;
  // For kStart alone; the bytes of folder and input follow, and the pipe's end is sent along.
  ProcessPool::Work work;
  double limit_s;
  std::uint64_t folder_size, input_size;
};

/// Message of a server to its pool.
struct Notice {
  enum class Kind : std::uint32_t { kStarted, kNotStarted, kEnded };
  Kind kind;
  std::uint64_t id;
  std::int32_t value;  ///< process; errno, 0 where the function is not known; status as waitpid() gives it
};

/// Makes the helper, unless this process has one.  @throws Error where the process has other threads
void prepare();
/// A new server.  @return the socket to it, which the caller closes
int connect();

// --- socket_message.cpp: whole messages over a stream; false where the other side is gone

bool send_bytes(int socket, const void* data, std::size_t size);
bool receive_bytes(int socket, void* data, std::size_t size);
/// Sends `size` > 0 bytes and an open file.
bool send_with_file(int socket, const void* data, std::size_t size, int file);
/// @param file  the open file that came along, or -1
bool receive_with_file(int socket, void* data, std::size_t size, int& file);

// --- work_process.cpp

/// In the process of a piece of work: does it and sends the outcome into the pipe; never returns.
/// @param server  the process that it must not outlive
[[noreturn]] void run_work(const Request& request, const std::string& folder, const std::string& input,
                           int pipe, pid_t server);
/// The first byte that run_work sends: what follows is the result, or an exception's message.
inline constexpr char kGood = 'g', kBad = 'b';

}  // namespace palpate::work_server
