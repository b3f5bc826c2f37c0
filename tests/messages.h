#pragma once
#include <gtest/gtest.h>

#include <exception>
#include <functional>
#include <string>

/// Helpers for tests of error messages.
namespace palpate::expectations {

/// Returns the message of the Error or InternalError that f throws; empty if it throws none.
inline std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const std::exception& e) { return e.what(); }
  return "";
}

inline void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "message: " << text;
}

}  // namespace palpate::expectations
