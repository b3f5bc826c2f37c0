#pragma once
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

/// Validators and texts of options that several commands share.
namespace palpate::cli {

inline constexpr const char* kSceneHelp =
    "scene file (.toml), or name of an included scene (`palpate list scenes`)";

/// Validator of a duration [s]. CLI::PositiveNumber accepts NaN, and its message prints the largest double.
inline const CLI::Validator duration(
    [](const std::string& text) {
      double seconds = 0.0;
      const bool usable = CLI::detail::lexical_cast(text, seconds) && seconds > 0.0 && std::isfinite(seconds);
      return usable ? std::string{} : fmt::format("{} must be a positive, finite number of seconds", text);
    },
    "");

/// Validator of a duration [s] that may be infinite: "inf".
inline const CLI::Validator duration_or_endless(
    [](const std::string& text) {
      double seconds = 0.0;
      const bool usable = CLI::detail::lexical_cast(text, seconds) && seconds > 0.0;
      return usable ? std::string{} : fmt::format("{} must be a positive number of seconds, or inf", text);
    },
    "");

/// Validator of a positive, finite number.
inline const CLI::Validator positive(
    [](const std::string& text) {
      double number = 0.0;
      const bool usable = CLI::detail::lexical_cast(text, number) && number > 0.0 && std::isfinite(number);
      return usable ? std::string{} : fmt::format("{} must be a positive, finite number", text);
    },
    "");

}  // namespace palpate::cli
