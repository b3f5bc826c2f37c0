#pragma once
#include "store/summary.h"

/// Values of a row of a summary.
namespace summary_rows {

/// Returns the value of a key; null where the row has none.
inline const palpate::store::SummaryValue* find(const palpate::store::SummaryFields& row,
                                                const std::string& key) {
  for (const auto& [name, value] : row)
    if (name == key) return &value;
  return nullptr;
}

/// Returns a count; -1 where the row has none of that key.
inline long long count(const palpate::store::SummaryFields& row, const std::string& key) {
  const palpate::store::SummaryValue* value = find(row, key);
  return value ? std::get<long long>(*value) : -1;
}

}  // namespace summary_rows
