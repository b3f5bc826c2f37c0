#pragma once
#include <filesystem>
#include <map>

#include "json.h"
#include "report/page.h"
#include "report/plot.h"
#include "report/table.h"
#include "report/work_precision.h"

/// The sections of a run's report, each from its own file or object.
/// A section with nothing to say adds nothing.
namespace palpate::report {

/// The plot as a figure, or, when it cannot be drawn, a paragraph with the reason: a page without one figure
/// is better than no page.
void add_plot(Page& page, const Plot& plot, const std::string& caption);

void add_head(Page& page, const Json& summary);     ///< what was run, in a few lines
void add_figures(Page& page, const Json& summary);  ///< all that was counted and timed
void add_pictures(Page& page, const Json& summary, const std::filesystem::path& dir);
void add_forces(Page& page, const Json& summary, const Table& force);
/// @param references  by scene  @param rules  how runs were repeated and limited
void add_comparison(Page& page, const Table& compare, const std::map<std::string, ReferenceError>& references,
                    const std::string& rules);
/// Histograms of clock.csv: how late ticks were, and what they took.
void add_clock(Page& page, const Table& clock);
void add_trace(Page& page, const Table& trace);
void add_restarts(Page& page, const Table& restarts);
void add_exchange(Page& page, const Table& exchange);
void add_methods(Page& page, const Table& methods);
/// @param summary  of the comparison: the reference's peaks and own errors, and fitted orders
void add_haptic(Page& page, const Table& haptic, const Json& summary);
/// study.csv with the times of its tasks in a column "cpu_s".
Table with_times(Table study, const Table& times);
/// @param text  of the study file  @param summary  which parameters are spaced by equal ratios
void add_study(Page& page, const Table& study, const std::string& text, const Json& summary);
void add_validation(Page& page, const Json& validation);
void add_stability(Page& page, const Json& stability);
/// @param file  its name
void add_bench(Page& page, const std::string& file, const Json& bench);
/// The view of the run's bodies over time; nothing where it recorded no step.
/// @param shown_at_s  when it is shown first; NaN: when the displacement is largest
void add_motion(Page& page, const std::filesystem::path& vtkhdf, double shown_at_s);
void add_parts(Page& page, const Json& summary);
void add_provenance(Page& page, const Json& summary);

}  // namespace palpate::report
