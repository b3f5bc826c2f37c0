#pragma once
#include <filesystem>

namespace palpate::report {

/// Builds DIR/report.html from what stands in a result directory: summary.json, force.csv, compare.csv, reference.json,
/// exchange.csv, validation.json, scene.toml, *.png.  A file that is not there has no section.  A plot that gnuplot cannot draw is replaced by a
/// paragraph with the reason (the page is still written).  Returns the page's path.  Throws Error when the directory holds none of these files.
std::filesystem::path write_run_report(const std::filesystem::path& dir);

}  // namespace palpate::report
