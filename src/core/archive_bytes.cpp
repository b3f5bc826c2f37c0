#include "core/archive_bytes.h"

#include "core/bytes.h"

namespace palpate {
namespace {

using Doubles = std::vector<double>;
using Integers = std::vector<std::int64_t>;

enum class Kind : char { kDoubles, kIntegers, kText };

}  // namespace

std::string to_bytes(const Archive::Values& values) {
  ByteWriter out;
  out.put(values.size());
  for (const auto& [name, value] : values) {
    out.put(name).put(static_cast<Kind>(value.index()));
    if (const auto* doubles = std::get_if<Doubles>(&value)) {
      out.put(*doubles);
    } else if (const auto* integers = std::get_if<Integers>(&value)) {
      out.put(integers->size());
      for (const std::int64_t one : *integers) out.put(one);
    } else {
      out.put(std::get<std::string>(value));
    }
  }
  return out.take();
}

Archive::Values values_of(const std::string& bytes) {
  ByteReader in(bytes);
  Archive::Values out;
  for (auto left = in.get<std::size_t>(); left > 0; --left) {
    Archive::Value& value = out[in.get<std::string>()];
    switch (in.get<Kind>()) {
      case Kind::kDoubles: value = in.get<Doubles>(); break;
      case Kind::kIntegers: {
        Integers list;
        for (auto count = in.get<std::size_t>(); count > 0; --count) list.push_back(in.get<std::int64_t>());
        value = std::move(list);
        break;
      }
      case Kind::kText: value = in.get<std::string>(); break;
    }
  }
  return out;
}

}  // namespace palpate
