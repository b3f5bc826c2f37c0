#pragma once
#include "cli/program.h"

namespace palpate::cli {

/// Parses palpate's command line.
/// @throws Error for an invalid line
Invocation parse(int argc, char** argv);

}  // namespace palpate::cli
