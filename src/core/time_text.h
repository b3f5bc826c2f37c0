#pragma once
#include <fmt/format.h>

#include <string>

namespace palpate {

/// Formats a simulated time [s] as standard output, pictures and pages show it: the shortest decimal with at
/// most nine significant digits, so that equal times read alike ("0.165" for 165 * 0.001, whose double
/// differs from 0.165).
inline std::string time_text(double time_s) { return fmt::format("{:.9g}", time_s); }

}  // namespace palpate
