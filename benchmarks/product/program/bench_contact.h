#pragma once
#include "options.h"

namespace palpate::cli {

/// Runs `palpate bench contact`: prints two tables per scene with one row per method, resolution and
/// number of threads, and the cost of contact relative to a step.
/// @return the exit status: kExitError if limits were to be checked and one is missed
int bench_contact(const BenchArguments& arguments);

}  // namespace palpate::cli
