// The one compiled copy of toml++ in this library.  Some of its own assertions fail on damaged text, which it
// then refuses all the same.  With NDEBUG they would be assumptions of the optimiser ([[assume]], by toml++
// 3.4 and GCC 14); without it they are what this macro says.
#undef NDEBUG
#define TOML_ASSERT(expression) static_cast<void>(0)
#define TOML_IMPLEMENTATION
#include <toml++/toml.h>
