#pragma once
#include "commands.h"

namespace palpate::cli {

/// `palpate bench contact`: a table a scene, a row a method, resolution and number of threads.
void bench_contact(const BenchArguments& arguments);

}  // namespace palpate::cli
