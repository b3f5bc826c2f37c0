#pragma once
#include <string>

namespace palpate {

/// Returns the file of the running program, with links resolved.  Where /proc is not mounted, the name that
/// the kernel recorded at the start (AT_EXECFN) is resolved instead.
/// @throws Error where neither leads to a file
std::string program_path();

/// Returns the folder for temporary files: TMPDIR, or /tmp.
/// @throws Error with the remedy, where that is no folder
std::string temporary_folder();

}  // namespace palpate
