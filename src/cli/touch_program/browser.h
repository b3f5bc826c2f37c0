#pragma once
#include <string>

namespace palpate::cli {

/// Returns whether a browser can be opened: the process has a display.
bool has_display();

/// Opens an address in the user's browser by xdg-open, without waiting for it. Returns false if xdg-open
/// cannot be started.
bool open_browser(const std::string& url);

}  // namespace palpate::cli
