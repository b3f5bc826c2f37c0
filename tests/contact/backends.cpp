#include "backends.h"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>

// Mesa leaks some hundred bytes, from libraries that it has unloaded by the end, so that no suppression could
// name them.  The same tests on the other backends look for leaks of our own.
int __lsan_is_turned_off() { return contact_tests::gpu_was_used(); }
#endif

namespace contact_tests {

bool& gpu_was_used() {
  static bool used = false;
  return used;
}

}  // namespace contact_tests
