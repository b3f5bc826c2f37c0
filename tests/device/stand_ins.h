#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/input.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

/// Stand-ins for the other side of a device: the daemon of a SpaceMouse, and an event file of a game pad.
namespace palpate::device {

/// Listens on a Unix socket, as spacenavd does, and sends packets of eight i32 to its client.
class SpacemouseServer {
 public:
  explicit SpacemouseServer(const std::string& path)
      : listener_(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(listener_, 1), 0);
  }
  ~SpacemouseServer() {
    hang_up();
    ::close(listener_);
  }
  SpacemouseServer(const SpacemouseServer&) = delete;
  SpacemouseServer& operator=(const SpacemouseServer&) = delete;

  void send(const std::array<std::int32_t, 8>& packet) { send_bytes(packet.data(), sizeof packet); }
  void send_bytes(const void* bytes, std::size_t size) {
    EXPECT_EQ(::send(client(), bytes, size, MSG_NOSIGNAL), static_cast<ssize_t>(size));
  }
  /// Returns the bytes that the client has sent so far.
  std::string received() {
    std::string out(64, '\0');
    const ssize_t n = ::recv(client(), out.data(), out.size(), MSG_DONTWAIT);
    out.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return out;
  }
  void hang_up() {
    if (client_ >= 0) ::close(client_);
    client_ = -1;
  }

 private:
  int client() {
    if (client_ < 0) client_ = ::accept(listener_, nullptr, nullptr);
    EXPECT_GE(client_, 0);
    return client_;
  }
  int listener_, client_ = -1;
};

/// Named pipe that carries recorded events of a game pad.
class EventPipe {
 public:
  explicit EventPipe(const std::string& path) {
    EXPECT_EQ(::mkfifo(path.c_str(), 0600), 0);
    file_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK);
    EXPECT_GE(file_, 0);
  }
  ~EventPipe() { ::close(file_); }
  EventPipe(const EventPipe&) = delete;
  EventPipe& operator=(const EventPipe&) = delete;

  void send(int type, int code, int value) {
    input_event event{};
    event.type = static_cast<std::uint16_t>(type);
    event.code = static_cast<std::uint16_t>(code);
    event.value = value;
    EXPECT_EQ(::write(file_, &event, sizeof event), static_cast<ssize_t>(sizeof event));
  }

 private:
  int file_ = -1;
};

}  // namespace palpate::device
