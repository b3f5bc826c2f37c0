#include "core/missing_outputs.h"

#include <fmt/format.h>

namespace palpate {

void MissingOutputs::add(const std::string& what, const std::string& why) {
  outputs_.push_back(fmt::format("{} ({})", what, why.substr(0, why.find('\n'))));
}

void MissingOutputs::add(const MissingOutputs& more) {
  outputs_.insert(outputs_.end(), more.outputs_.begin(), more.outputs_.end());
}

}  // namespace palpate
