#include "sections.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "palpate/core/error.h"
#include "palpate/report/force_plot.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

/// Keys of summary.json that have a section of their own; everything else stands under "The run".
const std::set<std::string> kProvenance = {"version", "versions", "commit", "cpu", "cores", "compiler", "build", "options", "host", "os", "gl", "date", "command", "command_line", "environment"};
const std::set<std::string> kElsewhere = {"in_use", "left_out", "scene_source", "pictures", "title", "files"};

/// Facts of an object's own entries, then each object inside it under a heading of its own.
void add_object(Page& page, const Json& object, const std::set<std::string>& only, const std::set<std::string>& without) {
  if (!object.is_object()) return;
  Json own = Json::object();
  for (const auto& [key, value] : object.items())
    if ((only.empty() || only.contains(key)) && !without.contains(key)) own[key] = value;
  page.add_facts(facts_of(own));
  for (const auto& [key, value] : own.items()) {
    const auto facts = facts_of(value);
    if (!facts.empty()) page.add_heading(key_text(key), 3).add_facts(facts);
  }
}

bool has_any(const Json& object, const std::set<std::string>& keys) {
  return object.is_object() && std::any_of(keys.begin(), keys.end(), [&](const std::string& key) { return object.contains(key); });
}

std::string sentence_case(std::string text) {
  std::replace_if(text.begin(), text.end(), [](char c) { return c == '-' || c == '_'; }, ' ');
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

/// The end of a caption: a limit is told here too, since one far above the curve is not drawn.
std::string limit_text(double limit, const char* unit) {
  return limit > 0.0 ? fmt::format("; the device can do at most {:g} {}.", limit, unit) : ".";
}

}  // namespace

void add_plot(Page& page, const Plot& plot, const std::string& caption) {
  try {
    page.add_svg(plot_svg(plot), caption);
  } catch (const Error& e) {
    page.add_paragraph("Figure not drawn (" + caption + "): " + e.what());
  }
}

void add_run(Page& page, const Json& summary) {
  std::set<std::string> without = kProvenance;
  without.insert(kElsewhere.begin(), kElsewhere.end());
  if (summary.is_object() && !summary.empty()) {
    page.add_heading("The run");
    add_object(page, summary, {}, without);
  }
}

void add_pictures(Page& page, const Json& summary, const fs::path& dir) {
  std::vector<fs::path> pngs;
  for (const auto& entry : fs::directory_iterator(dir))
    if (entry.path().extension() == ".png") pngs.push_back(entry.path());
  std::sort(pngs.begin(), pngs.end());
  const Json captions = summary.is_object() && summary.contains("pictures") ? summary["pictures"] : Json::object();
  for (const fs::path& png : pngs)
    page.add_png(png, text_at(captions, png.filename().c_str(), sentence_case(png.stem().string())));
}

void add_forces(Page& page, const Json& summary, const Table& force) {
  const Json device = summary.is_object() && summary.contains("device") ? summary["device"] : Json::object();
  page.add_heading("Force on the hand");
  const double max_force = number_at(device, "max_force_n"), max_torque = number_at(device, "max_torque_n_m");
  add_plot(page, force_plot(force, max_force), "Force that the device sends to the hand, in world components and as a magnitude" + limit_text(max_force, "N"));
  const bool has_torque = std::any_of(force.headers.begin(), force.headers.end(), [](const std::string& h) { return h.ends_with("_n_m"); });
  if (has_torque) add_plot(page, torque_plot(force, max_torque), "Torque, likewise" + limit_text(max_torque, "N m"));
}

void add_validation(Page& page, const Json& validation) {
  const Json& cases = validation.is_object() && validation.contains("cases") ? validation["cases"] : validation;
  if (!cases.is_array()) return;
  std::vector<std::vector<std::string>> rows;
  std::vector<RowMark> marks;
  for (const Json& one : cases) {
    if (!one.is_object() || !one.contains("measurements")) continue;
    if (one["measurements"].empty()) {
      rows.push_back({text_at(one, "name"), "nothing was measured", "-", "-", "-", "-", "-", "FAIL"});
      marks.push_back(RowMark::kBad);
    }
    for (const Json& m : one["measurements"]) {
      const bool passed = m.value("passed", false);
      std::string order = short_number(number_at(m, "order"));
      if (std::isfinite(number_at(m, "order_low"))) order += fmt::format(" in [{:g}, {:g}]", number_at(m, "order_low"), number_at(m, "order_high"));
      rows.push_back({text_at(one, "name"), text_at(m, "quantity"), fmt::format("{:.6g}", number_at(m, "computed")), fmt::format("{:.6g}", number_at(m, "exact")),
                      short_number(number_at(m, "error")), short_number(number_at(m, "bar")), order, passed ? "pass" : "FAIL"});
      marks.push_back(passed ? RowMark::kGood : RowMark::kBad);
    }
  }
  const auto failed = std::count(marks.begin(), marks.end(), RowMark::kBad);
  page.add_heading("Validation against exact answers");
  page.add_paragraph(failed == 0 ? fmt::format("All {} measurements pass.", rows.size()) : fmt::format("{} of {} measurements FAIL.", failed, rows.size()));
  page.add_table({"case", "quantity", "computed", "exact", "error", "bar", "order", "verdict"}, rows, "Errors are relative unless the quantity says otherwise.", marks);
}

void add_parts(Page& page, const Json& summary) {
  if (!has_any(summary, {"in_use", "left_out"})) return;
  page.add_heading("Parts");
  std::vector<std::pair<std::string, std::string>> facts;
  for (const auto& [key, label] : {std::pair{"in_use", "in use"}, std::pair{"left_out", "left out"}}) {
    if (!summary.contains(key)) continue;
    std::string text = value_text(summary[key]);
    if (summary[key].is_object())
      for (const auto& [part, reason] : summary[key].items()) text += (text.empty() ? "" : "; ") + part + ": " + value_text(reason);
    facts.emplace_back(label, text.empty() ? "none" : text);
  }
  page.add_facts(facts);
}

void add_provenance(Page& page, const Json& summary) {
  if (!has_any(summary, kProvenance)) return;
  page.add_heading("Provenance");
  add_object(page, summary, kProvenance, {});
}

}  // namespace palpate::report
