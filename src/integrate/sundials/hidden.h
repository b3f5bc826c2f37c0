#pragma once

/// Marks namespaces that use SUNDIALS' types: their symbols are not exported from the library.
#define PALPATE_HIDDEN __attribute__((visibility("hidden")))
