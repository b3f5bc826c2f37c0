#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace palpate {

/// Option with a fixed set of values.  The enumeration counts from 0, and option_names(), beside it, returns
/// the names of its values in their order, as scene files and messages write them:
///
///     enum class Fill { kEmpty, kSolid };
///     constexpr std::array<std::string_view, 2> option_names(Fill) { return {"empty", "solid"}; }
template <class E>
concept NamedEnum = std::is_enum_v<E> && requires {
  option_names(E{}).size();
};

/// Returns the name of a value.
template <NamedEnum E>
constexpr std::string_view name_of(E value) {
  return option_names(value)[static_cast<std::size_t>(value)];
}

/// Returns the value called `name`; empty: none.
template <NamedEnum E>
constexpr std::optional<E> value_named(std::string_view name) {
  const auto names = option_names(E{});
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return static_cast<E>(i);
  return {};
}

/// Returns the names of some values, or of all.
template <NamedEnum E>
std::vector<std::string> names_of_options(const std::vector<E>& some = {}) {
  std::vector<std::string> out;
  for (const E value : some) out.emplace_back(name_of(value));
  if (some.empty())
    for (const std::string_view name : option_names(E{})) out.emplace_back(name);
  return out;
}

}  // namespace palpate
