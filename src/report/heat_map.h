#pragma once
#include <string>
#include <vector>

namespace palpate::report {

/// One cell of a heat map.
struct HeatCell {
  std::string letter;     ///< readable without colour
  std::string css;        ///< class of its colour: "v0" ... "v8", or empty where there is no such cell
  std::string title;      ///< tooltip
  bool outlined = false;  ///< not what was expected
};

/// A group of rows under a heading of its own.
struct HeatGroup {
  std::string name, summary;
  std::vector<std::string> rows;
  std::vector<std::vector<HeatCell>> cells;  ///< one vector a row, one cell a column
};

/// A table with a coloured letter in each cell and upright column names; well-formed, everything escaped.
std::string heat_map_html(const std::vector<std::string>& columns, const std::vector<HeatGroup>& groups);
/// The meaning of the letters, a line each.
std::string heat_key_html(const std::vector<HeatCell>& cells);

}  // namespace palpate::report
