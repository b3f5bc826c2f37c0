#pragma once
#include "options.h"

namespace palpate::cli {

/// Runs `palpate bench continuity`: prints one row per scene, and its jumps by cause.
void bench_continuity(const BenchArguments& arguments);

}  // namespace palpate::cli
