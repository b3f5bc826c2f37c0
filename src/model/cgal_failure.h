#pragma once
#include <CGAL/exceptions.h>

#include <exception>
#include <sstream>
#include <string>

namespace palpate::model {

/// The reason that CGAL gives for an exception, on one line: it writes several, with its files.
inline std::string reason_of(const std::exception& e) {
  const auto* const failure = dynamic_cast<const CGAL::Failure_exception*>(&e);
  std::istringstream words(failure ? failure->message() + " (" + failure->expression() + ")"
                                   : std::string(e.what()));
  std::string out, word;
  while (words >> word) out += (out.empty() ? "" : " ") + word;
  return out;
}

}  // namespace palpate::model
