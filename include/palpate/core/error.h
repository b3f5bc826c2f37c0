#pragma once
#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Error in a user's input.  The message contains the fault, the location (file:line: key), the value, and
/// the remedy.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Defect of palpate: a broken invariant.  Thrown by PALPATE_CHECK, never because of bad input.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws Error with an fmt-formatted message.
template <class... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(fmt::format(format, std::forward<Args>(args)...));
}

namespace detail {
/// Throws InternalError with the location, the condition and the message.
[[noreturn]] void check_failed(const char* file, int line, const char* condition, const std::string& message);
}  // namespace detail

/// Returns the candidate with the smallest edit distance to `name`; empty when none is close (distance > half
/// its length).
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// Returns ` (did you mean "x"?)` or, when no candidate is close, ` (known: a, b, c)`; for the end of an
/// error message.
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace palpate

/// Checks an invariant in every build.  PALPATE_CHECK(n == m, "n = {}, m = {}", n, m)
#define PALPATE_CHECK(condition, ...)                                                            \
  do {                                                                                           \
    if (!(condition))                                                                            \
      ::palpate::detail::check_failed(__FILE__, __LINE__, #condition, fmt::format(__VA_ARGS__)); \
  } while (false)
