#include "store/json_text.h"

#include "core/whole_number.h"
#include "palpate/core/error.h"

namespace palpate::store {
namespace {

using Json = nlohmann::ordered_json;
constexpr int kMostNested = 64;

/// Checks each parser event: nesting depth and size of whole numbers.
bool check(int depth, Json::parse_event_t event, const Json& value, const std::string& path) {
  if (depth > kMostNested) fail("{}: is not a result of palpate: it nests deeper than {}", path, kMostNested);
  if (event != Json::parse_event_t::value || !value.is_number_integer()) return true;
  const bool beyond = value.is_number_unsigned() ? beyond_whole(value.get<std::uint64_t>())
                                                 : beyond_whole(value.get<std::int64_t>());
  if (beyond) fail("{}: {} {}", path, value.dump(), kWholeDemand);
  return true;
}

}  // namespace

Json parse_json(const std::string& text, const std::string& path) {
  try {
    return Json::parse(text, [&](int depth, Json::parse_event_t event, const Json& value) {
      return check(depth, event, value, path);
    });
  } catch (const nlohmann::json::exception& e) {
    fail("{}: is not valid JSON: {}; if the run that wrote it was interrupted, run it again", path, e.what());
  }
}

}  // namespace palpate::store
