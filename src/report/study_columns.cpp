#include "study_columns.h"

#include <algorithm>
#include <map>

#include "json.h"
#include "report/work_precision.h"

namespace palpate::report {
namespace {

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

/// Columns of every study, varied or not.
const std::vector<std::string> kAlways = {"scene", "integrator", "rtol", "step_s", "seed"};

}  // namespace

StudyColumns columns_of_study(const Table& study) {
  StudyColumns out;
  const std::size_t first = study.column("task") + 1, last = study.column("status");
  for (std::size_t c = first; c < last; ++c) {
    const std::string& name = study.headers[c];
    out.settings.push_back(name);
    if (name == "seed") out.seeds = true;
    if (!contains(kAlways, name)) (out.seeds ? out.drawn : out.swept).push_back(name);
  }
  return out;
}

std::string parameter_text(const std::string& name) {
  static const std::map<std::string, std::string> words = {
      {"youngs modulus", "Young's modulus"}, {"poissons ratio", "Poisson's ratio"},
      {"rtol", "relative tolerance"},        {"step", "step size"},
      {"state period", "period of states"},  {"spectral radius", "spectral radius at infinite frequency"}};
  const std::size_t dot = name.rfind('.');
  std::string key = key_text(dot == std::string::npos ? name : name.substr(dot + 1));
  const std::size_t unit = std::min(key.find(" ["), key.size());
  if (const auto found = words.find(key.substr(0, unit)); found != words.end())
    key.replace(0, unit, found->second);
  if (dot == std::string::npos) return key;
  std::string owner = name.substr(0, dot);
  std::replace_if(
      owner.begin(), owner.end(), [](char c) { return c == '.' || c == '_'; }, ' ');
  return owner + ": " + key;
}

std::vector<StudyFigure> shown_figures(const Table& study) {
  static const std::vector<StudyFigure> all = {{"peak_force_n", "peak force on the hand [N]"},
                                               {"largest_displacement_m", "largest displacement [m]"},
                                               {"steps", "number of steps"},
                                               {"cpu_s", "CPU time [s]"}};
  std::vector<StudyFigure> out;
  for (const StudyFigure& one : all)
    if (study.has(one.column) && distinct(study, one.column).size() > 1) out.push_back(one);
  return out;
}

std::vector<StudyGroup> groups_of(const Table& study, const StudyColumns& columns,
                                  const std::vector<std::string>& without) {
  std::vector<std::size_t> by;
  for (const std::string& name : columns.settings)
    if (!contains(without, name) && distinct(study, name).size() > 1) by.push_back(study.column(name));
  std::vector<StudyGroup> out;
  for (std::size_t r = 0; r < study.rows.size(); ++r) {
    std::string name;
    for (const std::size_t c : by) {
      const std::string cell = shown_cell(study.rows[r][c]);
      const bool named =
          contains(kAlways, study.headers[c]) && study.headers[c] != "rtol" && study.headers[c] != "step_s";
      if (!cell.empty()) name += (name.empty() ? "" : ", ") + (named ? cell : study.headers[c] + " " + cell);
    }
    const auto at =
        std::find_if(out.begin(), out.end(), [&](const StudyGroup& group) { return group.name == name; });
    (at == out.end() ? out.emplace_back(StudyGroup{name, {}}) : *at).rows.push_back(r);
  }
  return out;
}

}  // namespace palpate::report
