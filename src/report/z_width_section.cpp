#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"
#include "sections.h"

/// Section for z_width.csv of `palpate stability --haptic`.
namespace palpate::report {
namespace {

/// Returns a column of stiffnesses [N/m] over the damping, in ascending order of damping.
Series stiffness_of(const Table& z_width, const char* column, const std::string& name, Mark mark) {
  const std::vector<double> damping = z_width.numbers("damping_n_s_m"), stiffness = z_width.numbers(column);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < damping.size(); ++i)
    if (std::isfinite(damping[i]) && std::isfinite(stiffness[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return damping[a] < damping[b]; });
  Series out{.name = name, .x = {}, .y = {}, .mark = mark};
  for (const std::size_t i : order) {
    out.x.push_back(damping[i]);
    out.y.push_back(stiffness[i]);
  }
  return out;
}

/// Returns the operating points of the scene: coupling and contact in series, at the damping of the coupling.
Series scene_points(const Json& summary) {
  Series out{.name = "", .x = {}, .y = {}, .mark = Mark::kPoints, .colour = "ink"};
  out.reading = "scene";
  const double damping = number_at(section_of(summary, "haptic_stability"), "coupling_damping_n_s_m");
  for (const Json& point : list_of(summary, "operating_points")) {
    if (text_at(point, "motion") != "translation") continue;
    out.x.push_back(damping);
    out.y.push_back(number_at(point, "stiffness_with_coupling_n_m"));
    out.labels.push_back(text_at(point, "name"));
  }
  return out;
}

}  // namespace

void add_z_width(Page& page, const Table& z_width, const Json& summary) {
  Plot plot = log_log_plot("damping of the wall [N s/m]", "largest stiffness of the wall [N/m]");
  plot.height = 520;
  plot.series = {stiffness_of(z_width, "k_passive_n_m", "passive", Mark::kLine),
                 stiffness_of(z_width, "k_spectral_n_m", "stable, exact", Mark::kLine),
                 stiffness_of(z_width, "k_delay_bound_n_m", "delay bound", Mark::kDashed),
                 stiffness_of(z_width, "k_simulated_n_m", "stable, simulated", Mark::kPoints),
                 stiffness_of(z_width, "coupling_in_contact_n_m", "coupling, tool pressed", Mark::kDashed),
                 scene_points(summary)};
  page.add_heading("Stiffness that the haptic loop can render");
  add_plot(
      page, plot, "z_width.csv",
      "Largest stiffness of a virtual wall over its damping: by passivity, by the exact linear map, by the "
      "bound for a delay, and by simulation; and the largest stiffness of the coupling with the tool "
      "pressed on the stiffest contact. Single points: the contacts of the scene, in series with its "
      "coupling.");
}

}  // namespace palpate::report
