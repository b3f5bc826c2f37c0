#pragma once
#include <string>

namespace palpate::cli {

/// Prints docs/keys.md: all keys of a scene, table by table, from the tables of the loader.
void print_key_page();
/// Prints docs/study-keys.md: all keys of a study.
void print_study_key_page();

/// Returns the text escaped for a cell of a Markdown table.
std::string markdown_cell(const std::string& text);

}  // namespace palpate::cli
