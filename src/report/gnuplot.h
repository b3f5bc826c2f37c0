#pragma once
#include <string>

namespace palpate::report {

/// Runs gnuplot in a temporary directory on a script whose output goes to `plot.svg` (a relative path), and
/// returns the text of that file.
/// @throws Error with the message of gnuplot, or with the name of the package if gnuplot is not installed
std::string run_gnuplot(const std::string& script);

}  // namespace palpate::report
