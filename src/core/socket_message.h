#pragma once
#include <cstddef>

/// Whole messages over a stream socket.  Each function returns false where the other side is gone.
namespace palpate::work_server {

bool send_bytes(int socket, const void* data, std::size_t size);
bool receive_bytes(int socket, void* data, std::size_t size);
/// Sends `size` > 0 bytes and an open file descriptor.
bool send_with_file(int socket, const void* data, std::size_t size, int file);
/// Receives `size` bytes.  @param file  file descriptor that was passed along, or -1
bool receive_with_file(int socket, void* data, std::size_t size, int& file);

}  // namespace palpate::work_server
