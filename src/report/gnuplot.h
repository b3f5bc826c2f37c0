#pragma once
#include <string>

namespace palpate::report {

/// Runs gnuplot on a script whose output goes to `plot.svg` (a relative path: it runs in a temporary
/// directory of its own), and returns that file's text.  Throws Error with gnuplot's own message, or with the
/// package's name when there is no gnuplot.
std::string run_gnuplot(const std::string& script);

}  // namespace palpate::report
