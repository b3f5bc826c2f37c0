#pragma once
#include "options.h"

namespace palpate::cli {

/// Runs `palpate bench fem` over sizes of the beam.
void bench_fem_sizes(const BenchArguments& arguments);

}  // namespace palpate::cli
