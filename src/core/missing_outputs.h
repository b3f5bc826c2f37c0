#pragma once
#include <string>
#include <vector>

namespace palpate {

/// Outputs that were requested and could not be delivered, while everything else succeeded.
class MissingOutputs {
 public:
  /// Adds a missing output `what` and the reason `why`, of which the first line counts.
  void add(const std::string& what, const std::string& why);
  /// Adds the outputs that are missing from a part of the work.
  void add(const MissingOutputs& more);
  bool empty() const { return outputs_.empty(); }
  /// Returns one line per output: "OUTPUT (REASON)".
  const std::vector<std::string>& outputs() const { return outputs_; }

 private:
  std::vector<std::string> outputs_;
};

}  // namespace palpate
