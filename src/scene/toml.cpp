// The one compiled copy of toml++ in this library.
#define TOML_IMPLEMENTATION
#include <toml++/toml.h>
