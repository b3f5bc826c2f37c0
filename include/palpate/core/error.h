#pragma once
#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// A person's input is at fault.  The message says what, where (file:line: key), the value, and what to do.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A defect of palpate: a broken invariant.  Thrown by PALPATE_CHECK, never by bad input.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// throw Error with an fmt-formatted message.
template <class... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(fmt::format(format, std::forward<Args>(args)...));
}

namespace detail {
[[noreturn]] void check_failed(const char* file, int line, const char* condition, const std::string& message);
}  // namespace detail

/// The candidate with the smallest edit distance to `name`; empty when none is close (distance > half its
/// length).
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// ` (did you mean "x"?)` or, when none is near, ` (known: a, b, c)`; for the end of an error message.
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace palpate

/// Checks an invariant, in every build.  PALPATE_CHECK(n == m, "n = {}, m = {}", n, m)
#define PALPATE_CHECK(condition, ...)                                                            \
  do {                                                                                           \
    if (!(condition))                                                                            \
      ::palpate::detail::check_failed(__FILE__, __LINE__, #condition, fmt::format(__VA_ARGS__)); \
  } while (false)
