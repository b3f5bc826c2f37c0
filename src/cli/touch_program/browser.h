#pragma once
#include <string>

namespace palpate::cli {

/// Returns whether a browser can be opened: the process has a display.
bool has_display();

/// Page that forwards to an address, in a file that only this user can read: the address has a token, and
/// other users of the machine can read the arguments of programs. The destructor removes the file.
class ForwardingPage {
 public:
  ForwardingPage() = default;
  ~ForwardingPage();
  ForwardingPage(const ForwardingPage&) = delete;
  ForwardingPage& operator=(const ForwardingPage&) = delete;
  /// Writes the file and opens it in the user's browser by xdg-open, without waiting for it. Returns false if
  /// that fails.
  /// @param url  without characters that HTML escapes
  bool open(const std::string& url);

 private:
  std::string path_;
};

}  // namespace palpate::cli
