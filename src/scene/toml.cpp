// The one compiled copy of toml++ in this library.  Some of its own assertions fail on damaged text, which it
// then refuses all the same.
#define TOML_ASSERT(expression) static_cast<void>(0)
#define TOML_IMPLEMENTATION
#include <toml++/toml.h>
