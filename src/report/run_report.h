#pragma once
#include <filesystem>
#include <vector>

#include "report/first_view.h"
#include "report/page.h"

namespace palpate {
class MissingOutputs;
}

namespace palpate::report {

/// Written page, and the figures that are missing from it.
struct RunReport {
  std::filesystem::path page;
  std::vector<Page::MissingFigure> missing_figures;
};

/// Writes one page of the results in directories of any mix: runs, comparisons, validations, stability
/// matrices, benchmarks. The answers of each result come first; several directories become sections after a
/// list of contents. The files read are summary.json, force.csv, clock.csv, trace.csv, run.vtkhdf,
/// compare.csv, reference.json, restarts.csv, exchange.csv, methods.csv, haptic.csv, validation.json,
/// stability.json, bench-fem.json, bench-fem-accuracy.json, bench-contact.json and *.png; the source of the
/// scene comes from summary.json, or else from scene.toml. docs/files.md lists the keys of
/// summary.json. A missing file has no section. A chart without any value to draw is replaced by a
/// paragraph with the reason, and the page is still written.
/// @throws Error if a directory contains none of these files, or one of them is invalid
/// @pre dirs not empty
RunReport write_report(const std::vector<std::filesystem::path>& dirs, const std::filesystem::path& path,
                       const FirstView& view = {});

/// Writes the page of one directory, DIR/report.html.
RunReport write_run_report(const std::filesystem::path& dir);

/// Adds the figures that are missing from a page, grouped by reason, to the missing outputs of a command.
void add_missing(const RunReport& report, MissingOutputs& missing);

}  // namespace palpate::report
