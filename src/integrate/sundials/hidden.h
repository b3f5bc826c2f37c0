#pragma once

/// Namespaces that name SUNDIALS' types: no symbol of theirs leaves the library.
#define PALPATE_HIDDEN __attribute__((visibility("hidden")))
