#pragma once
#include <string>
#include <string_view>

namespace palpate::store {

/// Writes a small file whole or not at all: a temporary file beside it, then a rename.
/// A reader never sees half of it.
void write_atomically(const std::string& path, std::string_view content);

std::string read_file(const std::string& path);  ///< @throws Error

}  // namespace palpate::store
