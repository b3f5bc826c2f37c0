#pragma once
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

namespace palpate::cli {

/// Formatter that prints help identically with every release of CLI11: the default of an option as "N=10",
/// the form up to release 2.3, where 2.4.1 prints "N [10] ".
class HelpFormatter final : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(34); }

  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    const std::string value = option->get_default_str(), bracketed = fmt::format(" [{}] ", value);
    if (const auto at = text.find(bracketed); !value.empty() && at != std::string::npos)
      text.replace(at, bracketed.size(), "=" + value);
    return text;
  }
};

}  // namespace palpate::cli
