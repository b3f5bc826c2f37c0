#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "commands.h"
#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "palpate/loop/registries.h"
#include "palpate/report/table.h"
#include "palpate/validation/validation.h"
#include "paths.h"

namespace palpate::cli {
namespace {

const char* const kKeys = "keys";

loop::ChoiceList case_choices() {
  loop::ChoiceList out{"cases", "with a known answer: palpate validate", {}};
  for (const validation::ValidationCase& one : validation::validation_cases())
    out.choices.push_back({one.name, one.summary + (one.slow ? " (slow)" : "")});
  return out;
}

/// The first comment line of a scene file says what it is.
std::string first_comment(const std::string& path) {
  const std::string text = read_text(path);
  const std::size_t begin = text.find_first_not_of("# \t\r\n");
  if (text.empty() || text[0] != '#' || begin == std::string::npos) return "";
  return text.substr(begin, text.find('\n', begin) - begin);
}

loop::ChoiceList scene_choices() {
  loop::ChoiceList out{"scenes", "that come with palpate: palpate run NAME", {}};
  for (const std::string& path : shipped_scenes())
    out.choices.push_back({std::filesystem::path(path).stem().string(), first_comment(path)});
  return out;
}

void print(const loop::ChoiceList& list) {
  const bool orders = std::any_of(list.choices.begin(), list.choices.end(),
                                  [](const loop::Choice& c) { return c.order > 0; });
  std::vector<std::vector<std::string>> rows;
  for (const loop::Choice& choice : list.choices) {
    rows.push_back({choice.name, choice.summary});
    if (orders)
      rows.back().insert(rows.back().begin() + 1, choice.order > 0 ? std::to_string(choice.order) : "-");
  }
  fmt::print("{} ({})\n", list.what, list.summary);
  if (rows.empty()) rows.push_back({"-", "none in this build"});
  const std::vector<std::string> headers = orders ? std::vector<std::string>{"name", "order", "what it is"}
                                                  : std::vector<std::string>{"name", "what it is"};
  fmt::print("{}\n", report::format_table(headers, rows));
}

std::string in_short(std::vector<std::string> users) {
  constexpr std::size_t kMost = 4;
  if (users.size() > kMost) {
    const std::string rest = fmt::format("{} more", users.size() - kMost + 1);
    users.resize(kMost - 1);
    users.push_back(rest);
  }
  return fmt::format("{}", fmt::join(users, ", "));
}

/// The table that a person reads: what may stand in a scene, key by key.
void print_keys() {
  std::string table = "\n";
  std::vector<std::vector<std::string>> rows;
  const auto flush = [&] {
    if (rows.empty()) return;
    fmt::print("[{}]\n{}\n", table,
               report::format_table({"key", "type", "unit", "range", "default", "meaning", "used by"}, rows));
    rows.clear();
  };
  for (const scene::KeyRow& row : scene::key_rows(loop::kinds())) {
    if (row.table.empty()) continue;  // the tables themselves
    if (row.table != table) flush();
    table = row.table;
    rows.push_back({row.name, row.type, row.unit, row.range, row.required ? "required" : row.fallback,
                    row.meaning, in_short(row.users)});
  }
  flush();
}

}  // namespace

int list(const ListArguments& arguments) {
  std::vector<loop::ChoiceList> lists = loop::registries();
  lists.push_back(case_choices());
  lists.push_back(scene_choices());
  std::vector<std::string> known = {kKeys};
  bool found = arguments.what == kKeys;
  if (found) print_keys();
  for (const loop::ChoiceList& one : lists) {
    known.push_back(one.what);
    if (!arguments.what.empty() && arguments.what != one.what) continue;
    print(one);
    found = true;
  }
  if (!found) fail("there is no list \"{}\"{}", arguments.what, suggestion(arguments.what, known));
  return 0;
}

}  // namespace palpate::cli
