#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace palpate::experiments {

/// Parses a list of indices, "0-3,7", and returns them in ascending order.  @throws Error for invalid text
/// and for indices out of range
std::vector<std::size_t> indices_of(const std::string& text, std::size_t tasks);
/// Formats indices as indices_of() reads them.  @pre ascending
std::string text_of(const std::vector<std::size_t>& indices);

}  // namespace palpate::experiments
