#include "experiments/indices.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "palpate/core/error.h"

namespace palpate::experiments {
namespace {

std::size_t index_of(const std::string& word, const std::string& text, std::size_t tasks) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
  if (word.empty() || error != std::errc{} || end != word.data() + word.size())
    fail("tasks \"{}\": must be numbers and ranges, as in 0-3,7", text);
  if (index >= tasks) fail("tasks \"{}\": there are tasks 0 to {}, and no {}", text, tasks - 1, index);
  return index;
}

}  // namespace

std::vector<std::size_t> indices_of(const std::string& text, std::size_t tasks) {
  std::vector<std::size_t> out;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) {
    const std::size_t dash = part.find('-');
    const std::size_t first = index_of(part.substr(0, dash), text, tasks);
    const std::size_t last = dash == std::string::npos ? first : index_of(part.substr(dash + 1), text, tasks);
    if (last < first) fail("tasks \"{}\": the range {} runs backwards", text, part);
    for (std::size_t i = first; i <= last; ++i) out.push_back(i);
  }
  if (out.empty()) fail("tasks \"{}\": must be numbers and ranges, as in 0-3,7", text);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::string text_of(const std::vector<std::size_t>& indices) {
  std::string out;
  for (std::size_t i = 0; i < indices.size();) {
    std::size_t last = i;
    while (last + 1 < indices.size() && indices[last + 1] == indices[last] + 1) ++last;
    out += fmt::format("{}{}", out.empty() ? "" : ",", indices[i]);
    if (last > i) out += fmt::format("-{}", indices[last]);
    i = last + 1;
  }
  return out;
}

}  // namespace palpate::experiments
