#pragma once
#include "options.h"

namespace palpate::cli {

/// `palpate bench contact`: two tables a scene, a row a method, resolution and number of threads, and what
/// contact costs beside a step.
/// @return the exit status: kExitError where a bar was to be checked and is missed
int bench_contact(const BenchArguments& arguments);

}  // namespace palpate::cli
