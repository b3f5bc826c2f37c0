#pragma once
#include <filesystem>
#include <map>

#include "json.h"
#include "report/first_view.h"
#include "report/page.h"
#include "report/plot.h"
#include "report/table.h"
#include "report/work_precision.h"

/// Sections of the report of a run, each from one file or object. A section without content adds nothing.
namespace palpate::report {

/// Adds the plot as a figure or, if it cannot be drawn, a paragraph with the reason: a page without one
/// figure is better than no page.
/// @param file  name of the file with its values
void add_plot(Page& page, const Plot& plot, const std::string& file, const std::string& caption);

void add_head(Page& page, const Json& summary);     ///< Adds the description of the run, a few lines
void add_figures(Page& page, const Json& summary);  ///< Adds all counts and times
/// Picture of a run, at the head of its page.
inline constexpr const char* kPicture = "picture.png";
void add_pictures(Page& page, const std::filesystem::path& dir);  ///< Adds the other pictures
/// Adds force and torque on the hand.
/// @param dir  folder of the run, whose haptic.h5 has the phases of the touch
void add_forces(Page& page, const Json& summary, const Table& force, const std::filesystem::path& dir);
/// Adds a comparison.
/// @param references  references by scene
/// @param rules       how runs were repeated and limited
void add_comparison(Page& page, const Table& compare, const std::map<std::string, ReferenceError>& references,
                    const std::string& rules);
/// Adds histograms of clock.csv: lateness and work of ticks.
void add_clock(Page& page, const Table& clock);
void add_trace(Page& page, const Table& trace);
void add_restarts(Page& page, const Table& restarts);
void add_exchange(Page& page, const Table& exchange);
void add_methods(Page& page, const Table& methods);
/// Adds the errors of a haptic comparison.
/// @param summary  summary of the comparison: peaks and errors of the reference, and fitted orders
void add_haptic(Page& page, const Table& haptic, const Json& summary);
/// Adds the errors due to elements, skin and contact points.
/// @param summary  summary of the comparison: estimates and orders
void add_mesh(Page& page, const Table& mesh, const Json& summary);
/// Returns study.csv with the CPU times of its tasks in a column "cpu_s".
Table with_times(Table study, const Table& times);
/// Adds a study.
/// @param text     text of the study file
/// @param summary  specifies which parameters are spaced by equal ratios
void add_study(Page& page, const Table& study, const std::string& text, const Json& summary);
void add_validation(Page& page, const Json& validation);
void add_stability(Page& page, const Json& stability);
/// Adds the stiffness that a haptic loop can render, from z_width.csv.
/// @param summary  contains the operating points of the scene
void add_z_width(Page& page, const Table& z_width, const Json& summary);
/// Adds a benchmark.
/// @param file  name of its file
void add_bench(Page& page, const std::string& file, const Json& bench);
/// Adds the view of the bodies over time; nothing if no step was recorded.
/// @param summary     has the view of the pictures, the free bodies and the names of the tools
/// @param shown_at_s  time shown first [s]; NaN: time of the largest displacement
/// @param first       first view, in place of that of the pictures
void add_motion(Page& page, const std::filesystem::path& vtkhdf, const Json& summary, double shown_at_s,
                const FirstView& first);
void add_parts(Page& page, const Json& summary);
void add_provenance(Page& page, const Json& summary);

}  // namespace palpate::report
