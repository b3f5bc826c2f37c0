#include "sections.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "palpate/core/error.h"
#include "plot_json.h"
#include "report/force_plot.h"
#include "store/atomic_file.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

/// Groups of figures that other sections show.
const std::set<std::string> kElsewhere = {"in_use", "left_out", "pictures", "logarithmic"};

/// Returns a group of figures from summary.json, or an empty object.
Json figures_of(const Json& summary, const char* group) {
  if (!summary.is_object() || !summary.contains("figures") || !summary["figures"].is_object() ||
      !summary["figures"].contains(group))
    return Json::object();
  return summary["figures"][group];
}

/// Adds the facts of an object, then each object inside it as a group.
void add_object(Page& page, const Json& object, const std::set<std::string>& without) {
  page.add_facts(facts_of(object));
  std::vector<std::pair<std::string, Page::Facts>> groups;
  if (object.is_object())
    for (const auto& [key, value] : object.items())
      if (auto facts = facts_of(value); !without.contains(key) && !facts.empty())
        groups.emplace_back(key_text(key), std::move(facts));
  if (!groups.empty()) page.add_fact_groups(groups);
}

std::string sentence_case(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '-' || c == '_'; }, ' ');
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

/// Returns the end of a caption with the limit of the device, since a limit far above the curve is not drawn.
std::string limit_text(double limit, const char* unit) {
  return limit > 0.0 ? fmt::format("; device limit {:g} {}.", limit, unit) : ".";
}

}  // namespace

void add_plot(Page& page, const Plot& plot, const std::string& caption) {
  try {
    page.add_chart(plot_svg(plot), plot_json(plot), caption);
  } catch (const Error& e) { page.add_missing_figure(caption, e.what()); }
}

void add_head(Page& page, const Json& summary) {
  Page::Facts facts;
  for (const char* key : {"command", "scene", "outcome", "message", "overrides"})
    if (summary.is_object() && summary.contains(key))
      if (std::string text = value_text(summary[key]); !text.empty())
        facts.emplace_back(key_text(key), std::move(text));
  const Json options = figures_of(summary, "options"), sizes = figures_of(summary, "sizes"),
             timings = figures_of(summary, "timings");
  for (const auto& [object, key] : {std::pair{&options, "integrator"},
                                    {&sizes, "nodes"},
                                    {&sizes, "tetrahedra"},
                                    {&timings, "simulated_s"},
                                    {&timings, "loop_cpu_s"}})
    if (object->contains(key)) facts.emplace_back(key_text(key), value_text((*object)[key]));
  if (facts.empty()) return;
  page.add_heading("Run");
  page.add_facts(facts);
}

void add_figures(Page& page, const Json& summary) {
  if (!summary.is_object() || !summary.contains("figures")) return;
  page.begin_details("All counts and times");
  add_object(page, summary["figures"], kElsewhere);
  page.end_details();
}

void add_pictures(Page& page, const Json& summary, const fs::path& dir) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(dir))
    if (entry.path().extension() == ".png" || entry.path().extension() == ".svg")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  const Json captions = figures_of(summary, "pictures");
  for (const fs::path& file : files) {
    // "picture" is no useful caption; that picture contains a title
    const std::string stem = file.stem().string();
    const std::string caption =
        text_at(captions, file.filename().c_str(), stem == "picture" ? "" : sentence_case(stem));
    if (file.extension() == ".png")
      page.add_png(file, caption);
    else
      page.add_svg(store::read_file(file.string()), caption);
  }
}

void add_forces(Page& page, const Json& summary, const Table& force) {
  const Json options = figures_of(summary, "options");
  page.add_heading("Force on the hand");
  if (force.rows.empty()) {
    page.add_paragraph("No tick was written before the run ended.");
    return;
  }
  const double max_force = number_at(options, "max_force_n"),
               max_torque = number_at(options, "max_torque_n_m");
  add_plot(page, force_plot(force, max_force),
           "Force of the device on the hand: world components and magnitude" + limit_text(max_force, "N"));
  constexpr double kRounding = 1e-15;  // [N m]
  const bool has_torque = std::any_of(force.headers.begin(), force.headers.end(), [&](const std::string& h) {
    if (!h.ends_with("_n_m")) return false;
    const std::vector<double> values = force.numbers(h);
    return std::any_of(values.begin(), values.end(), [](double v) { return !(std::abs(v) <= kRounding); });
  });
  if (!has_torque) page.add_paragraph("No torque: no moment acts on the tool in this scene.");
  if (has_torque)
    add_plot(
        page, torque_plot(force, max_torque),
        "Torque of the device on the hand: world components and magnitude" + limit_text(max_torque, "N m"));
}

void add_parts(Page& page, const Json& summary) {
  std::vector<std::vector<std::string>> rows;
  std::vector<RowMark> marks;
  const Json in_use = figures_of(summary, "in_use"), left_out = figures_of(summary, "left_out");
  for (const auto& [part, why] : in_use.items()) {
    rows.push_back({part, "in use", value_text(why)});
    marks.push_back(RowMark::kNone);
  }
  for (const auto& [part, why] : left_out.items()) {
    rows.push_back({part, "left out", value_text(why)});
    marks.push_back(RowMark::kFaint);
  }
  if (rows.empty()) return;
  page.begin_details(fmt::format("{} parts in use or left out, with reasons", rows.size()));
  page.add_table({"part", "", "reason"}, rows, "", marks);
  page.end_details();
}

void add_provenance(Page& page, const Json& summary) {
  if (!summary.is_object() || !summary.contains("provenance")) return;
  page.add_heading("Provenance");
  add_object(page, summary["provenance"], {});
}

}  // namespace palpate::report
