#pragma once
#include <string>
#include <vector>

namespace palpate::report {

/// Answer of a result in words: a leading sentence and details.
struct Answer {
  std::string lead;                      ///< Leading sentence
  std::vector<std::string> points = {};  ///< Details
  bool asks = false;  ///< Whether the lead is the question or its subject, which the points answer
  bool empty() const { return lead.empty() && points.empty(); }
};

}  // namespace palpate::report
