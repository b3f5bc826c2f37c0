#pragma once
#include <filesystem>
#include <vector>

#include "palpate/report/page.h"

namespace palpate::report {

/// A page that was written, and the figures that it should hold and lacks.
struct RunReport {
  std::filesystem::path page;
  std::vector<Page::MissingFigure> missing_figures;
};

/// Builds DIR/report.html from what stands in a result directory: summary.json, force.csv, clock.csv,
/// compare.csv, reference.json, exchange.csv, haptic.csv, validation.json, stability.json, *.png; the scene's
/// source is that in summary.json, else scene.toml.  In summary.json, the figures' groups `in_use` and
/// `left_out` (part: why) become one table, and `pictures` (file name: caption) names the pictures.  A file
/// that is not there has no section.  A plot that gnuplot cannot draw is replaced by a paragraph with the
/// reason (the page is still written).  Throws Error when the directory holds none of these files.
RunReport write_run_report(const std::filesystem::path& dir);

}  // namespace palpate::report
