#pragma once
#include "options.h"

namespace palpate::cli {

/// `palpate bench continuity`: a row a scene, and its jumps by cause.
void bench_continuity(const BenchArguments& arguments);

}  // namespace palpate::cli
