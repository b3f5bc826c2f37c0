#pragma once
#include "options.h"

namespace palpate::cli {

/// palpate bench fem over sizes; or, with arguments.calibrate, the table of linear_solver = "auto".
void bench_fem_sizes(const BenchArguments& arguments);

}  // namespace palpate::cli
