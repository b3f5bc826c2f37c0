#pragma once
#include <fmt/format.h>

#include <string>

namespace palpate {

/// A simulated time for people [s], the one way in which standard output, pictures and pages write it: the
/// shortest decimal with at most nine significant digits, so that equal times read alike ("0.165" for
/// 165 * 0.001, whose double is another than that of 0.165).
inline std::string time_text(double time_s) { return fmt::format("{:.9g}", time_s); }

}  // namespace palpate
