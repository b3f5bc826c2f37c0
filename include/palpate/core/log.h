#pragma once
#include <spdlog/spdlog.h>

#include <string>
#include <vector>

/// Messages to the person at the terminal: spdlog on standard error, level set once by the command line.
namespace palpate::log {

using spdlog::debug;
using spdlog::error;
using spdlog::info;
using spdlog::warn;

/// Pattern and level; for a program's main, before it changes `stderr`.  A library user who never calls it
/// gets spdlog's default.  Messages are printable() then.
void configure(bool quiet, bool verbose);

/// Every different warning since configure(), in the order of its first: results keep them (summary.json).
std::vector<std::string> warnings();

}  // namespace palpate::log
