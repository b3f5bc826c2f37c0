#include "key_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "palpate/loop/load.h"
#include "palpate/scene/kinds.h"
#include "scene/study.h"

namespace palpate::cli {
namespace {

constexpr const char* kIntroduction = R"(# Every key of a scene: unit, range, default and meaning

<!-- Made by `palpate list keys --markdown` from the loader's own tables; a test compares them. -->

A scene is a TOML file of the tables below. `[x]` appears once, `[[x]]` any number of times. All numbers are
in SI units, and a key with a unit ends in it. "Required" marks keys that a scene must contain if it has the
table. "Used by" lists the choices (of `integrator.name`, `obstacle.type`, ...) that accept the key; if it is
empty, the key is always accepted. A scene with a key that is not accepted or not listed here is rejected with
file, line and column, and with the nearest known key.

[0, 1] includes its ends, (0, 1) does not. [names.md](names.md) has the names of integrators, solvers,
obstacles and other parts. `--set TABLE.KEY=VALUE` changes one value for one run; the tables of `[[x]]` count
from 0: `--set body.0.youngs_modulus_pa=2e4`.

| table | what it is |
|---|---|
)";

constexpr const char* kStudyIntroduction = R"(# Every key of a study: unit, range, default and meaning

<!-- Made by `palpate list study-keys --markdown` from the loader's own tables; a test compares them. -->

A study is a TOML file of the tables below, which `palpate study` runs; see [studies.md](studies.md).
`[x]` appears once, `[[x]]` any number of times. All numbers are in SI units. An unknown key is rejected with
file, line and column, and with the nearest known key. [keys.md](keys.md) lists the keys of a scene, which the
`key` of `[[sweep]]` and `[[random]]` specifies.

| table | what it is |
|---|---|
)";

using KeyRows = std::vector<scene::KeyRow>;

bool is_table(const scene::KeyRow& row) { return row.type == "table" || row.type == "tables"; }

std::string path_of(const scene::KeyRow& row) {
  return row.table.empty() ? row.name : row.table + "." + row.name;
}

std::string bracketed(const scene::KeyRow& table) {
  return fmt::format(fmt::runtime(table.type == "tables" ? "[[{}]]" : "[{}]"), path_of(table));
}

/// Returns the anchor of a heading: GitHub and MkDocs keep only letters, digits and `_`.
std::string anchor(const scene::KeyRow& table) {
  std::string out = path_of(table);
  std::erase(out, '.');
  return out;
}

std::string as_code(const std::string& text) { return text.empty() ? "" : "`" + text + "`"; }

std::string range_of(const scene::KeyRow& row, const scene::Kinds& kinds) {
  if (!row.range.empty())
    return row.type == "text" || row.type == "list of texts" ? markdown_cell(row.range) : as_code(row.range);
  for (const scene::KindTable& table : kinds)
    if (table.table == row.table && table.selector == row.name) return "a name: [names.md](names.md)";
  return is_table(row) ? "" : "any";
}

std::string default_of(const scene::KeyRow& row) {
  if (row.required) return "required";
  if (row.fallback.empty()) return "none";
  return row.is_value ? as_code(markdown_cell(row.fallback)) : markdown_cell(row.fallback);
}

std::string users_of(const scene::KeyRow& row) {
  constexpr std::size_t kMost = 6;
  std::vector<std::string> shown;
  for (const std::string& user : row.users) shown.push_back(as_code(user));
  if (shown.size() > kMost) {
    const std::size_t more = shown.size() - (kMost - 1);
    shown.resize(kMost - 1);
    shown.push_back(fmt::format("{} more", more));
  }
  return fmt::format("{}", fmt::join(shown, ", "));
}

/// Prints one table of keys. Without kinds no row has users, and that column is left out.
void print_table(const scene::KeyRow& table, const KeyRows& rows, const scene::Kinds& kinds) {
  const bool users = !kinds.empty();
  fmt::print("\n## {}\n\n`{}`:\n{}.\n\n", path_of(table), bracketed(table), table.meaning);
  fmt::print("| key | type | unit | range | default | meaning |{}\n|---|---|---|---|---|---|{}\n",
             users ? " used by |" : "", users ? "---|" : "");
  for (const scene::KeyRow& row : rows)
    if (row.table == path_of(table))
      fmt::print("| `{}` | {} | {} | {} | {} | {} |{}\n", row.name, row.type, row.unit, range_of(row, kinds),
                 default_of(row), markdown_cell(row.meaning),
                 users ? fmt::format(" {} |", users_of(row)) : "");
}

void print_page(const char* introduction, const KeyRows& rows, const scene::Kinds& kinds) {
  fmt::print("{}", introduction);
  KeyRows tables;
  for (const scene::KeyRow& row : rows)
    if (is_table(row) && std::any_of(rows.begin(), rows.end(),
                                     [&](const scene::KeyRow& one) { return one.table == path_of(row); }))
      tables.push_back(row);
  // key_rows lists the rows of a table before the rows of its nested tables; the page orders tables as the
  // scene does, by path
  std::vector<std::string> order;
  for (const scene::KeyRow& row : rows)
    if (!row.table.empty() && std::find(order.begin(), order.end(), row.table) == order.end())
      order.push_back(row.table);
  std::sort(tables.begin(), tables.end(), [&](const scene::KeyRow& a, const scene::KeyRow& b) {
    return std::find(order.begin(), order.end(), path_of(a)) <
           std::find(order.begin(), order.end(), path_of(b));
  });
  for (const scene::KeyRow& table : tables)
    fmt::print("| [`{}`](#{}) | {} |\n", bracketed(table), anchor(table), markdown_cell(table.meaning));
  for (const scene::KeyRow& table : tables) print_table(table, rows, kinds);
}

}  // namespace

std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '*') out += '\\';
    out += c;
  }
  return out;
}

void print_key_page() {
  const scene::Kinds kinds = loop::kinds();
  print_page(kIntroduction, scene::key_rows(kinds), kinds);
}

void print_study_key_page() { print_page(kStudyIntroduction, scene::study_key_rows(), {}); }

}  // namespace palpate::cli
