#pragma once
#include <array>
#include <string_view>

/// Colours shared by the plots and the page.
namespace palpate::report {

/// Mid-tone colours with a contrast of 3:1 against both the light and the dark page; distinguishable by
/// lightness, too, with the common colour deficiencies.
inline constexpr std::array<std::string_view, 8> kPalette = {"#2b7bba", "#d9720a", "#2a9461", "#b0529e",
                                                             "#8a6d3b", "#d1495b", "#0f9aa8", "#7a7f8a"};

inline constexpr std::string_view kGridColour = "#dde1e6";   ///< Replaced by the style sheet in dark mode
inline constexpr std::string_view kFloorColour = "#eceff2";  ///< Area below the error of the reference

/// Style sheet of the page.
extern const char* const kStyleSheet;

}  // namespace palpate::report
