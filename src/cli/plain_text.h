#pragma once
#include <cstddef>
#include <string>

namespace palpate::cli {

/// Markdown as a terminal shows it: headings underlined, paragraphs and lists filled to the width, code
/// indented by four, tables aligned (where they are too wide, one cell a line), links with their target:
/// `palpate help TOPIC` where that is a page of docs/.  Comments are left out.
///
/// What docs/ uses is known: `#` headings, fences of three backticks, `-`, `*` and `1.` lists of one level,
/// pipe tables with `\|`, links and images in brackets, `**bold**`, `` `code` ``.  All else is text.
/// @param width  columns; code and tables' longest words may be wider
std::string plain_text(const std::string& markdown, std::size_t width);

/// The text of the first `# ` heading; empty where there is none.
std::string title_of(const std::string& markdown);

}  // namespace palpate::cli
