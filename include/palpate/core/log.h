#pragma once
#include <spdlog/spdlog.h>

/// Messages to the person at the terminal: spdlog on standard error, level set once by the command line.
namespace palpate::log {

using spdlog::debug;
using spdlog::error;
using spdlog::info;
using spdlog::warn;

/// Pattern and level; for a program's main, before it changes `stderr`.  A library user who never calls it
/// gets spdlog's default.  Messages are printable() then.
void configure(bool quiet, bool verbose);

}  // namespace palpate::log
