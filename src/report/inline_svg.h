#pragma once
#include <string>

namespace palpate::report {

/// Makes a gnuplot SVG document fit to stand inside HTML: prolog, namespaces and tooltips dropped, ids
/// prefixed (they must be unique in the page), black replaced by the text's colour, grid and floor left to
/// the page's style sheet.
std::string inline_svg(const std::string& document, const std::string& id_prefix);

}  // namespace palpate::report
