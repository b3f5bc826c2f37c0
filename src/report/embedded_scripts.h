#pragma once
#include <string_view>

namespace palpate::report {

/// Scripts of the page, defined in a file generated from page/dist at build time (embed.cmake). page_script()
/// sorts tables and draws charts. view_script() rotates and plays a result; it needs three_script() before
/// it, which defines THREE, also for the page of `palpate touch`.
std::string_view page_script();
std::string_view three_script();
std::string_view view_script();

}  // namespace palpate::report
