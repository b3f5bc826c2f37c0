#pragma once
#include <string>

/// Standard output and standard error, for all code of a program that prints.
namespace palpate::cli {

/// From here on, what is printed to `stdout` and `stderr` passes printable(), so that no name in a file or on
/// the command line reaches the terminal with control characters; and a stream that refuses (a full disk, a
/// closed descriptor) ends no command in the middle: output_failure() says so when it is over.  Standard
/// descriptors that are closed are opened on /dev/null, so that no file of results takes their number.
void guard_streams();

/// Flushes both.  Why standard output has not taken everything; empty: it has.
std::string output_failure();

}  // namespace palpate::cli
