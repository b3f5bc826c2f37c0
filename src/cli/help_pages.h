#pragma once
#include <string_view>
#include <vector>

namespace palpate::cli {

/// A page of docs/ as the program carries it.
struct HelpPage {
  std::string_view topic;     ///< the file's name without ".md"
  std::string_view markdown;  ///< the whole file
};

/// Every page, in the order of PALPATE_PAGES (CMakeLists.txt); made by embed_pages.cmake.
const std::vector<HelpPage>& help_pages();

}  // namespace palpate::cli
