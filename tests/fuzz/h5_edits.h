#pragma once
#include <string>
#include <string_view>

namespace palpate::fuzz {

/// Bytes as a list of changes to a good HDF5 file, which HDF5 itself makes: objects that are gone, other
/// shapes, other types, other numbers.  So a reader of ours is asked, and not HDF5, which does not survive
/// every damaged byte (core/rehearsal.h).
///
/// A change has 12 bytes:  object, what, row, column, 8 bytes of a number.
/// @param write_seed  makes the good file at a path
/// @return the changed file's path; valid until the next call
std::string edited(const char* name, void (*write_seed)(const std::string&), std::string_view bytes);

}  // namespace palpate::fuzz
