#include "palpate/core/archive.h"

#include <algorithm>
#include <cstring>

#include "palpate/core/error.h"

namespace palpate {

Archive::Archive(Values values, std::string where)
    : values_(std::move(values)), where_(std::move(where)), gives_back_(true) {}

void Archive::check_all_restored() const {
  for (const auto& [name, value] : values_)
    if (!asked_.contains(name))
      fail("{}: unexpected entry \"{}\"; the file belongs to another scene", where_, name);
}

void Archive::keep(std::string_view name, Value value) {
  const bool is_new = values_.emplace(full(name), std::move(value)).second;
  PALPATE_CHECK(is_new, "\"{}\" is archived twice", full(name));
}

const Archive::Value& Archive::given_value(std::string_view name) {
  const std::string whole = full(name);
  const auto at = values_.find(whole);
  if (at == values_.end()) fail("{}: \"{}\" is missing; the file belongs to another scene", where_, whole);
  asked_[whole] = true;
  return at->second;
}

void Archive::refuse_kind(std::string_view name) const {
  fail("{}: \"{}\" has the wrong type", where_, full(name));
}

void Archive::check_count(std::string_view name, std::size_t kept, std::size_t requested) const {
  if (kept != requested)
    fail("{}: \"{}\" has {} numbers, must have {}; the file belongs to another scene", where_, full(name),
         kept, requested);
}

void Archive::numbers(std::string_view name, std::span<double> values) {
  if (!gives_back_) return keep(name, std::vector<double>(values.begin(), values.end()));
  const auto& kept = given<std::vector<double>>(name);
  check_count(name, kept.size(), values.size());
  std::copy(kept.begin(), kept.end(), values.begin());
}

void Archive::integer(std::string_view name, std::int64_t& value) {
  if (!gives_back_) return keep(name, std::vector<std::int64_t>{value});
  const auto& kept = given<std::vector<std::int64_t>>(name);
  if (kept.size() != 1) fail("{}: \"{}\" must be one integer", where_, full(name));
  value = kept.front();
}

void Archive::raw(std::string_view name, std::span<char> bytes) {
  if (!gives_back_) return keep(name, std::string(bytes.begin(), bytes.end()));
  const auto& kept = given<std::string>(name);
  if (kept.size() != bytes.size())
    fail("{}: \"{}\" has {} bytes, must have {}", where_, full(name), kept.size(), bytes.size());
  std::memcpy(bytes.data(), kept.data(), bytes.size());
}

void Archive::operator()(std::string_view name, std::string& text) {
  if (!gives_back_) return keep(name, text);
  text = given<std::string>(name);
}

void Archive::operator()(std::string_view name, std::vector<double>& list) {
  if (!gives_back_) return keep(name, list);
  list = given<std::vector<double>>(name);
}

void Archive::operator()(std::string_view name, Pose& pose) {
  const Group group(*this, name);
  (*this)("rotation", pose.rotation);
  (*this)("translation", pose.translation);
}

void Archive::operator()(std::string_view name, Twist& twist) {
  const Group group(*this, name);
  (*this)("angular", twist.angular);
  (*this)("linear", twist.linear);
}

void Archive::operator()(std::string_view name, Wrench& wrench) {
  const Group group(*this, name);
  (*this)("moment", wrench.moment);
  (*this)("force", wrench.force);
}

void Archive::check_length(std::string_view name, std::int64_t size) const {
  constexpr std::int64_t kMost = 1 << 28;  // A damaged file must not request all of the memory.
  if (size < 0 || size > kMost) fail("{}: \"{}\" cannot have {} elements", where_, full(name), size);
}

void Archive::check_size(std::string_view name, Eigen::Index rows, Eigen::Index columns, int fixed_rows,
                         int fixed_columns) const {
  constexpr Eigen::Index kMost = Eigen::Index{1} << 32;
  const bool fits = rows >= 0 && columns >= 0 && (fixed_rows < 0 || rows == fixed_rows) &&
                    (fixed_columns < 0 || columns == fixed_columns) && rows <= kMost && columns <= kMost &&
                    (columns == 0 || rows <= kMost / columns);
  if (!fits) fail("{}: \"{}\" cannot have {} rows and {} columns", where_, full(name), rows, columns);
}

}  // namespace palpate
