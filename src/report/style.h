#pragma once
#include <array>
#include <string_view>

/// Colours that the plots and the page share.
namespace palpate::report {

/// Mid-tone colours that hold 3:1 against both the light and the dark page; distinguishable with the common
/// colour deficiencies by lightness too.
inline constexpr std::array<std::string_view, 8> kPalette = {"#2b7bba", "#d9720a", "#2a9461", "#b0529e",
                                                             "#8a6d3b", "#d1495b", "#0f9aa8", "#7a7f8a"};

inline constexpr std::string_view kGridColour = "#dde1e6";   ///< replaced by the page's own in dark mode
inline constexpr std::string_view kFloorColour = "#eceff2";  ///< below the reference's own error

/// The page's style sheet.
extern const char* const kStyleSheet;

}  // namespace palpate::report
