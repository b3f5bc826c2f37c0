#pragma once
#include <string>
#include <vector>

namespace palpate::report {

/// What a result answers, in words: a leading sentence and its particulars.
struct Answer {
  std::string lead;
  std::vector<std::string> points = {};
  bool asks = false;  ///< the lead is the question, or what it is about: the points answer it
  bool empty() const { return lead.empty() && points.empty(); }
};

}  // namespace palpate::report
