#include "live/access.h"

#include <arpa/inet.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "palpate/core/error.h"

namespace palpate::live {
namespace {

/// Returns the host without its port, in small letters; empty if the header is malformed.
std::string name_of(std::string_view host) {
  std::size_t end = host.size();
  if (host.starts_with("["))
    end = std::min(host.find(']') + 1, host.size());
  else
    end = std::min(host.find(':'), host.size());
  const std::string_view port = host.substr(end);
  if (!port.empty() &&
      (port[0] != ':' || port.size() > 6 ||
       !std::all_of(port.begin() + 1, port.end(), [](char c) { return c >= '0' && c <= '9'; })))
    return {};
  std::string out(host.substr(0, end));
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

bool is_address(const std::string& name) {
  std::array<unsigned char, 16> bytes{};
  if (::inet_pton(AF_INET, name.c_str(), bytes.data()) == 1) return true;
  return name.size() > 2 && name.front() == '[' &&
         ::inet_pton(AF_INET6, name.substr(1, name.size() - 2).c_str(), bytes.data()) == 1;
}

}  // namespace

std::string new_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    fail("the system gives no random numbers for the token of the page");
  std::string out;
  for (const unsigned char byte : bytes) out += fmt::format("{:02x}", byte);
  return out;
}

bool is_equal(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned>(static_cast<unsigned char>(b[i]));
  return difference == 0;
}

bool is_own_host(std::string_view host, bool loopback) {
  const std::string name = name_of(host);
  if (name == "localhost" || name == "127.0.0.1" || name == "[::1]") return true;
  if (loopback || name.empty()) return false;
  std::array<char, 256> own{};
  if (::gethostname(own.data(), own.size() - 1) != 0) own[0] = '\0';
  return is_address(name) || (own[0] != '\0' && name == name_of(own.data()));
}

bool is_own_origin(std::string_view origin, std::string_view host) {
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && !host.empty() && origin.substr(kScheme.size()) == host;
}

}  // namespace palpate::live
