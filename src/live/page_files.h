#pragma once
#include <string_view>

/// Files of the page, embedded from src/live/page/dist by embed.cmake.
namespace palpate::live {

std::string_view viewer_page();    ///< viewer.html
std::string_view viewer_script();  ///< viewer.js
std::string_view viewer_style();   ///< viewer.css

}  // namespace palpate::live
