#include "sections.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "palpate/core/error.h"
#include "report/force_plot.h"
#include "touch_phases.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

/// Figures that the page shows elsewhere.
const std::set<std::string> kElsewhere = {"parts", "log_spaced_parameters"};

/// Headings of the rows of lists in summary.json. Rows of other lists are a name and a value.
const std::map<std::string, std::string> kRowHeadings = {
    {"against_monolithic", "error against the monolithic solution"},
    {"contacts", "contact"},
    {"hands", "hand"},
    {"observed_orders", "observed order"},
    {"operating_points", "operating point"},
    {"reductions", "reduced response of the bodies"}};

/// Returns what a row is about, its first entry: "tool", "ball - tool".
std::string row_name(const Json& row) {
  const Json& first = row.begin().value();
  if (!first.is_array()) return value_text(first);
  std::string text;
  for (const Json& one : first) text += (text.empty() ? "" : " - ") + value_text(one);
  return text;
}

using Groups = std::vector<std::pair<std::string, Page::Facts>>;

/// Adds the rows of a list: a group for each, or one group of names and values.
void add_list(const std::string& key, const Json& list, Groups& groups) {
  const bool rows =
      std::all_of(list.begin(), list.end(), [](const Json& row) { return row.is_object() && !row.empty(); });
  if (!rows || list.empty()) return;
  const auto heading = kRowHeadings.find(key);
  Page::Facts pairs;
  for (Json row : list) {
    const std::string name = row_name(row);
    row.erase(row.begin());
    Page::Facts facts = facts_of(row);
    if (heading != kRowHeadings.end())
      groups.emplace_back(fmt::format("{}: {}", heading->second, name), std::move(facts));
    else
      for (const auto& fact : facts) pairs.emplace_back(name, fact.second);
  }
  if (!pairs.empty()) groups.emplace_back(key_text(key), std::move(pairs));
}

/// Adds the facts of an object, then each object and each list in it as groups.
void add_object(Page& page, const Json& object, const std::set<std::string>& without) {
  page.add_facts(facts_of(object));
  Groups groups;
  if (object.is_object())
    for (const auto& [key, value] : object.items()) {
      if (without.contains(key)) continue;
      if (value.is_array())
        add_list(key, value, groups);
      else if (auto facts = facts_of(value); !facts.empty())
        groups.emplace_back(key_text(key), std::move(facts));
    }
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

void add_plot(Page& page, const Plot& plot, const std::string& file, const std::string& caption) {
  try {
    page.add_chart(plot_json(plot), file, caption);
  } catch (const Error& e) { page.add_missing_figure(caption, e.what()); }
}

void add_head(Page& page, const Json& summary) {
  Page::Facts facts;
  for (const char* key : {"command", "scene", "outcome", "message", "overrides"})
    if (summary.is_object() && summary.contains(key))
      if (std::string text = value_text(summary[key]); !text.empty())
        facts.emplace_back(key_text(key), std::move(text));
  const Json options = section_of(summary, "options"), sizes = section_of(summary, "sizes"),
             timings = section_of(summary, "timings");
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

void add_pictures(Page& page, const fs::path& dir) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(dir))
    if (entry.path().extension() == ".png" && entry.path().filename() != kPicture)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) page.add_png(file, sentence_case(file.stem().string()));
}

void add_forces(Page& page, const Json& summary, const Table& force, const fs::path& dir) {
  const Json hands = list_of(summary, "hands"), hand = hands.empty() ? Json::object() : hands[0];
  page.add_heading("Force on the hand");
  if (force.rows.empty()) {
    page.add_paragraph("No tick was written before the run ended.");
    return;
  }
  const double max_force = number_at(hand, "max_force_n"), max_torque = number_at(hand, "max_torque_n_m");
  const std::vector<Span> phases = touch_phases(read_touch(dir));
  const auto with_phases = [&](Plot plot) {
    plot.spans = phases;
    return plot;
  };
  add_plot(page, with_phases(force_plot(force, max_force)), "force.csv",
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
        page, with_phases(torque_plot(force, max_torque)), "force.csv",
        "Torque of the device on the hand: world components and magnitude" + limit_text(max_torque, "N m"));
}

void add_parts(Page& page, const Json& summary) {
  Rows rows;
  std::vector<RowMark> marks;
  for (const Json& part : list_of(summary, "parts")) {
    if (!part.is_object()) continue;
    const bool used = part.contains("used") && part["used"] == true;
    rows.push_back({text_at(part, "name"), used ? "in use" : "left out", text_at(part, "why")});
    marks.push_back(used ? RowMark::kNone : RowMark::kFaint);
  }
  if (rows.empty()) return;
  page.begin_details(fmt::format("{} parts in use or left out, with reasons", rows.size()));
  page.add_table({"part", "", "reason"}, rows, "", marks);
  page.end_details();
}

void add_provenance(Page& page, const Json& summary) {
  if (!summary.is_object() || !summary.contains("provenance")) return;
  page.begin_details("Provenance: version, machine and libraries");
  add_object(page, summary["provenance"], {});
  page.end_details();
}

}  // namespace palpate::report
