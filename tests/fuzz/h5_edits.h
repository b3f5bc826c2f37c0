#pragma once
#include <string>
#include <string_view>

namespace palpate::fuzz {

/// Interprets bytes as a list of changes to a valid HDF5 file, which HDF5 itself applies: removed objects,
/// other shapes, types or numbers. This tests palpate's readers rather than HDF5, which does not survive
/// every damaged byte (core/sandbox.h). A change has 12 bytes: object, what, row, column, 8 bytes of a
/// number.
/// @param write_seed  makes the good file at a path
/// @return the changed file's path; valid until the next call
std::string edited(const char* name, void (*write_seed)(const std::string&), std::string_view bytes);

}  // namespace palpate::fuzz
