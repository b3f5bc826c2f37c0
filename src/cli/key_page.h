#pragma once
#include <string>

namespace palpate::cli {

/// Prints docs/keys.md: every key of a scene, table by table, from the loader's own tables.
void print_key_page();
/// Likewise of a study, docs/study-keys.md.
void print_study_key_page();

/// Text as a cell of a Markdown table.
std::string markdown_cell(const std::string& text);

}  // namespace palpate::cli
