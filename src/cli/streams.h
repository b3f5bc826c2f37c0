#pragma once
#include <string>

/// Standard output and standard error, for all code of a program that prints.
namespace palpate::cli {

/// Replaces `stdout` and `stderr` by streams that pass all output through printable(), so that no name in a
/// file or on the command line reaches the terminal with control characters. A stream that fails (a full
/// disk, a closed descriptor) does not abort the command; output_failure() reports the failure at its end.
/// Closed standard descriptors are opened on /dev/null, so that no file of results gets their number.
void guard_streams();

/// Flushes both streams. Returns why standard output is incomplete; empty if it is complete.
std::string output_failure();

}  // namespace palpate::cli
