#pragma once
#include <string>

namespace palpate {

/// The file of the program that runs, without links.  Where /proc is not mounted, the name that it was
/// started by is taken, as the kernel hands it over.
/// @throws Error where neither leads to a file
std::string program_path();

/// The folder for temporary files: TMPDIR, or /tmp.
/// @throws Error where that is no folder, with what to do
std::string temporary_folder();

}  // namespace palpate
