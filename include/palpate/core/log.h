#pragma once
#include <spdlog/spdlog.h>

#include <string>
#include <vector>

/// Messages to the user: spdlog on standard error; the command line sets the level once.
namespace palpate::log {

using spdlog::debug;
using spdlog::error;
using spdlog::info;
using spdlog::warn;

/// Sets pattern and level, and makes messages printable().  Called by a program's main before it redirects
/// `stderr`; without the call, a user of the library gets spdlog's default logger.
void configure(bool quiet, bool verbose);

/// Returns the distinct warnings since configure() or forget_warnings(), in order of first occurrence;
/// summary.json stores them.  After 1000 texts, one more gives the number of the other warnings.
std::vector<std::string> warnings();

/// Forgets the warnings of an earlier run of the process.
void forget_warnings();

}  // namespace palpate::log
