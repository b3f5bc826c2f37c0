#pragma once
#include <string>
#include <vector>

namespace palpate::report {

/// Cell of a heat map.
struct HeatCell {
  std::string letter;     ///< Letter, readable without colour
  std::string css;        ///< CSS class of the colour: "v0" ... "v8"; empty if the cell does not exist
  std::string title;      ///< Tooltip
  bool outlined = false;  ///< Whether the result is not the expected one
};

/// Group of rows under a separate heading.
struct HeatGroup {
  std::string name, summary;
  std::vector<std::string> rows;
  std::vector<std::vector<HeatCell>> cells;  ///< One vector per row, one cell per column
};

/// Returns a table with a coloured letter in each cell and vertical column names, as well-formed HTML with
/// all text escaped.
std::string heat_map_html(const std::vector<std::string>& columns, const std::vector<HeatGroup>& groups);
/// Returns the legend of the letters, one line per letter.
std::string heat_key_html(const std::vector<HeatCell>& cells);

}  // namespace palpate::report
