#include "core/counters.h"

#include <memory>
#include <mutex>

namespace palpate::counters {
namespace {
struct Table {
  std::mutex mutex;
  std::map<std::string, std::unique_ptr<std::atomic<long>>, std::less<>> values;
};
Table& table() {
  static Table t;
  return t;
}
}  // namespace

std::atomic<long>& counter(std::string_view name) {
  Table& t = table();
  const std::lock_guard lock(t.mutex);
  auto it = t.values.find(name);
  if (it == t.values.end())
    it = t.values.emplace(std::string(name), std::make_unique<std::atomic<long>>(0)).first;
  return *it->second;
}

std::map<std::string, long> snapshot() {
  Table& t = table();
  const std::lock_guard lock(t.mutex);
  std::map<std::string, long> out;
  for (const auto& [name, value] : t.values) out[name] = value->load();
  return out;
}

void reset() {
  Table& t = table();
  const std::lock_guard lock(t.mutex);
  for (auto& [name, value] : t.values) value->store(0);
}

}  // namespace palpate::counters
