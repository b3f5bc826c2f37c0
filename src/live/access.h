#pragma once
#include <string>
#include <string_view>

/// Access to the server: only a browser page of this server, opened with its token.
namespace palpate::live {

/// Returns a new token: 128 random bits of the system, in 32 hexadecimal digits.
/// @throws Error if the system gives none
std::string new_token();

/// Returns whether two texts are equal, in a time that does not depend on their content.
bool is_equal(std::string_view a, std::string_view b);

/// Returns whether the header `Host` may name this server. A foreign name that resolves to this machine (DNS
/// rebinding) is refused; the port is free, so that a forwarded one works (ssh -L).
/// @param loopback  whether the server listens on the loopback interface only; otherwise IP addresses and the
/// name of this machine are accepted too
bool is_own_host(std::string_view host, bool loopback);

/// Returns whether the header `Origin` is that of a page from this server.
bool is_own_origin(std::string_view origin, std::string_view host);

}  // namespace palpate::live
