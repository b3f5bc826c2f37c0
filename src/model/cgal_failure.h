#pragma once
#include <CGAL/exceptions.h>

#include <algorithm>
#include <exception>
#include <sstream>
#include <string>

namespace palpate::model {

/// Returns the reason that CGAL gives for an exception, on one line.  Its debugging information is omitted:
/// it contains memory addresses, with which the note in a model would differ from run to run.
inline std::string reason_of(const std::exception& e) {
  const auto* const failure = dynamic_cast<const CGAL::Failure_exception*>(&e);
  std::string text = failure ? failure->message() : e.what();
  text.erase(std::min(text.find("Debugging information"), text.size()));
  if (failure && !failure->expression().empty()) text += " (" + failure->expression() + ")";
  std::istringstream words(text);
  std::string out, word;
  while (words >> word) out += (out.empty() ? "" : " ") + word;
  return out;
}

}  // namespace palpate::model
