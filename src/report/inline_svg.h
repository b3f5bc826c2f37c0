#pragma once
#include <string>

namespace palpate::report {

/// Converts an SVG document of gnuplot for embedding in HTML: removes prolog, namespaces and tooltips,
/// prefixes ids (they must be unique in the page), replaces black by the text colour, and leaves grid and
/// floor to the style sheet of the page.
std::string inline_svg(const std::string& document, const std::string& id_prefix);

}  // namespace palpate::report
