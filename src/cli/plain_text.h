#pragma once
#include <cstddef>
#include <string>

namespace palpate::cli {

/// Returns Markdown formatted for a terminal: headings underlined, paragraphs and lists filled to the width,
/// code indented by four, tables aligned (tables that are too wide: one line per cell), links with their
/// target: `palpate help TOPIC` for a page of docs/. Comments are left out.
///
/// Supported are the elements that docs/ uses: `#` headings, fences of three backticks, `-`, `*` and `1.`
/// lists of one level, pipe tables with `\|`, links and images in brackets, `**bold**`, `` `code` ``.
/// Everything else is text.
/// @param width  columns; code and the longest words of tables may be wider
std::string plain_text(const std::string& markdown, std::size_t width);

/// Returns the text of the first `# ` heading; empty if there is none.
std::string title_of(const std::string& markdown);

}  // namespace palpate::cli
