#pragma once
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

/// Checks and texts of options that several commands share.
namespace palpate::cli {

inline constexpr const char* kSceneHelp =
    "a scene file (.toml), or the name of one that comes with palpate (`palpate list scenes`)";

/// CLI::PositiveNumber lets NaN pass, and its message spells out the largest double.
inline const CLI::Validator duration(
    [](const std::string& text) {
      double seconds = 0.0;
      const bool usable = CLI::detail::lexical_cast(text, seconds) && seconds > 0.0 && std::isfinite(seconds);
      return usable ? std::string{} : fmt::format("{} must be a positive, finite number of seconds", text);
    },
    "");

inline const CLI::Validator positive(
    [](const std::string& text) {
      double number = 0.0;
      const bool usable = CLI::detail::lexical_cast(text, number) && number > 0.0 && std::isfinite(number);
      return usable ? std::string{} : fmt::format("{} must be a positive, finite number", text);
    },
    "");

}  // namespace palpate::cli
