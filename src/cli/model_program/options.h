#pragma once
#include "model_arguments.h"

namespace palpate::cli {

/// Parses the command line.  @throws Error for an invalid line
ModelArguments parse_model(int argc, char** argv);

}  // namespace palpate::cli
