#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <sstream>

#include "cli/other_program.h"
#include "cli/paths.h"
#include "cli/program.h"
#include "commands.h"
#include "key_page.h"
#include "loop/registries.h"
#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "report/table.h"
#include "scene/study.h"

namespace palpate::cli {
namespace {

struct ListArguments {
  std::string what;       ///< Name of a list; empty: the names of the lists
  bool all = false;       ///< Prints all lists.
  bool markdown = false;  ///< Prints a page of docs/: keys.md, study-keys.md or names.md
};

const char* const kKeys = "keys";
const char* const kStudyKeys = "study-keys";

/// Returns the cases with a known answer, as palpate-validation prints them; empty if it is not built, or if
/// another list is requested.
loop::ChoiceList case_choices(const std::string& requested) {
  loop::ChoiceList out{"cases", "cases with a known answer: palpate validate", {}};
  if (!(requested.empty() || requested == out.what) || !is_there(kCases)) return out;
  std::istringstream lines(output_of(kCases));
  for (std::string name, summary; std::getline(lines, name, '\t') && std::getline(lines, summary);)
    out.choices.push_back({name, summary});
  return out;
}

loop::ChoiceList scene_choices() {
  loop::ChoiceList out{"scenes", "scenes that come with palpate: palpate run NAME", {}};
  for (const std::string& path : shipped_scenes())
    out.choices.push_back({std::filesystem::path(path).stem().string(), first_comment(path)});
  return out;
}

bool has_orders(const loop::ChoiceList& list) {
  return std::any_of(list.choices.begin(), list.choices.end(),
                     [](const loop::Choice& c) { return c.order > 0; });
}

/// Returns the width of the terminal; 0 if the output goes elsewhere, where lines are not broken.
std::size_t width_of_output() {
  winsize size{};
  if (::isatty(STDOUT_FILENO) != 1 || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return 0;
  return size.ws_col;
}

/// Prints the names of all lists with the number of their entries.
void print_overview(const std::vector<loop::ChoiceList>& lists) {
  report::Rows rows;
  for (const loop::ChoiceList& list : lists)
    rows.push_back({list.what, std::to_string(list.choices.size()), list.summary});
  rows.push_back({kKeys, std::to_string(scene::key_rows(loop::kinds()).size()), "every key of a scene"});
  rows.push_back({kStudyKeys, std::to_string(scene::study_key_rows().size()), "every key of a study"});
  fmt::print("{}\n`palpate list NAME` prints one list, `palpate list --all` every list of names\n",
             report::format_table({"list", "entries", "what it is"}, rows));
}

void print(const loop::ChoiceList& list) {
  const bool orders = has_orders(list);
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
  fmt::print("{}\n",
             report::format_table(headers, report::with_broken_lines(headers, rows, width_of_output())));
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

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

/// Prints the lists as a page, docs/names.md.
void print_names_page(const std::vector<loop::ChoiceList>& lists) {
  fmt::print(
      "# All names in scenes and options\n\n"
      "<!-- Made by `palpate list --markdown`; a test compares them. -->\n\n"
      "`palpate list` prints these tables in a terminal, `palpate list WHAT` one of them.\n");
  for (const loop::ChoiceList& list : lists) {
    fmt::print("\n## {}\n\n{}.\n\n", list.what, capitalised(markdown_cell(list.summary)));
    const bool orders = has_orders(list);
    fmt::print("| name |{} what it is |\n|---|{}---|\n", orders ? " order |" : "", orders ? "---|" : "");
    for (const loop::Choice& choice : list.choices) {
      const std::string order = choice.order > 0 ? std::to_string(choice.order) : "";
      fmt::print("| `{}` |{} {} |\n", choice.name, orders ? fmt::format(" {} |", order) : "",
                 markdown_cell(choice.summary));
    }
  }
}

/// Prints the keys of a scene or a study as tables for the terminal.
void print_keys(const std::vector<scene::KeyRow>& all) {
  std::string table = "\n";
  std::vector<std::vector<std::string>> rows;
  const auto flush = [&] {
    if (rows.empty()) return;
    fmt::print("[{}]\n{}\n", table,
               report::format_table({"key", "type", "unit", "range", "default", "meaning", "used by"}, rows));
    rows.clear();
  };
  for (const scene::KeyRow& row : all) {
    if (row.table.empty()) continue;  // a row that describes a table
    if (row.table != table) flush();
    table = row.table;
    rows.push_back({row.name, row.type, row.unit, row.range, row.required ? "required" : row.fallback,
                    row.meaning, in_short(row.users)});
  }
  flush();
}

int list(const ListArguments& arguments) {
  std::vector<loop::ChoiceList> lists = loop::registries();
  lists.push_back(case_choices(arguments.what));
  lists.push_back(scene_choices());
  if (arguments.markdown && arguments.what.empty()) {
    print_names_page(lists);
    return 0;
  }
  if (arguments.what.empty() && !arguments.all) {
    print_overview(lists);
    return 0;
  }
  if (!arguments.what.empty() && arguments.all)
    fail("--all prints every list; leave \"{}\" out", arguments.what);
  std::vector<std::string> known = {kKeys, kStudyKeys};
  bool found = std::find(known.begin(), known.end(), arguments.what) != known.end();
  if (arguments.markdown && !found)
    fail("--markdown requires \"keys\", \"study-keys\" or no list name, not \"{}\"", arguments.what);
  if (arguments.what == kKeys)
    arguments.markdown ? print_key_page() : print_keys(scene::key_rows(loop::kinds()));
  if (arguments.what == kStudyKeys)
    arguments.markdown ? print_study_key_page() : print_keys(scene::study_key_rows());
  for (const loop::ChoiceList& one : lists) {
    known.push_back(one.what);
    if (!arguments.what.empty() && arguments.what != one.what) continue;
    print(one);
    found = true;
  }
  if (!found) fail("there is no list \"{}\"{}", arguments.what, suggestion(arguments.what, known));
  return 0;
}

}  // namespace

void add_list(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("list", "print the names accepted in scenes and options");
  auto arguments = std::make_shared<ListArguments>();
  command->add_option(
      "WHAT", arguments->what,
      "integrators, linear-solvers, materials, laws, tool-integrators, obstacles, contact-methods, "
      "contact-springs, contact-laws, generators, devices, device-profiles, motions, parts, cases, scenes; "
      "default: the names of these lists; or keys: every key of a scene with its unit, range, default and "
      "meaning; or "
      "study-keys: the keys of a study");
  command->add_flag("--all", arguments->all, "all lists of names");
  command->add_flag(
      "--markdown", arguments->markdown,
      "as a page of the documentation: docs/keys.md with keys, docs/study-keys.md with study-keys, "
      "docs/names.md without WHAT");
  command->footer(R"(Examples:
  palpate list
  palpate list integrators
  palpate list keys)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return list(*arguments); }; });
}

}  // namespace palpate::cli
