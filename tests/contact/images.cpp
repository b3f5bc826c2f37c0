#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>

#include "contact/gpu_device.h"

// Mesa leaks a few hundred bytes, from libraries that are unloaded before exit, so that no suppression could
// name them.
int __lsan_is_turned_off() { return !palpate::contact::gpu_device().name.empty(); }
#endif
