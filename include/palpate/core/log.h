#pragma once
#include <spdlog/spdlog.h>

/// Messages to the person at the terminal: spdlog on standard error, level set once by the command line.
namespace palpate::log {

using spdlog::debug;
using spdlog::error;
using spdlog::info;
using spdlog::warn;

/// Pattern and sink; called once by a program's main.  A library user who never calls it gets spdlog's
/// default.
void configure(bool quiet, bool verbose);

}  // namespace palpate::log
