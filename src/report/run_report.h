#pragma once
#include <filesystem>
#include <vector>

#include "report/page.h"

namespace palpate::report {

/// A page that was written, and the figures that it should hold and lacks.
struct RunReport {
  std::filesystem::path page;
  std::vector<Page::MissingFigure> missing_figures;
};

/// Writes one page of what stands in result directories, any mix: runs, comparisons, validations, stability
/// matrices, benchmarks.  What each answers comes first; several directories are sections behind a list of
/// contents.  Read are summary.json, force.csv, clock.csv, trace.csv, run.vtkhdf, compare.csv,
/// reference.json, restarts.csv, exchange.csv, methods.csv, haptic.csv, validation.json, stability.json,
/// bench-fem.json, bench-fem-accuracy.json, bench-contact.json and *.png; the scene's source is that in
/// summary.json, else scene.toml.  In summary.json, the figures' groups `in_use` and `left_out` (part: why)
/// become one table, and `pictures` (file name: caption) names the pictures.  A file that is not there has no
/// section.  A plot that gnuplot cannot draw is replaced by a paragraph with the reason (the page is still
/// written).
/// @throws Error when a directory holds none of these files, or one of them is broken
/// @pre dirs not empty
RunReport write_report(const std::vector<std::filesystem::path>& dirs, const std::filesystem::path& path);

/// The page of one directory, DIR/report.html.
RunReport write_run_report(const std::filesystem::path& dir);

}  // namespace palpate::report
