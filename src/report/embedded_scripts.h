#pragma once
#include <string_view>

namespace palpate::report {

/// Scripts of the page, defined in a file made at build time (embed.cmake) from page/dist: what sorts tables
/// and draws charts, and what turns and plays a result.
std::string_view page_script();
std::string_view view_script();

}  // namespace palpate::report
