#pragma once
#include <string>
#include <vector>

namespace palpate::loop {

/// One name that a scene or an option knows.
struct Choice {
  std::string name, summary;
  int order = 0;  ///< theoretical order of accuracy where there is one, else 0
};

/// Every registry of every part that was compiled in, under the name that `palpate list` knows it by:
/// "integrators", "linear-solvers", "tool-integrators", "devices", "parts".
struct ChoiceList {
  std::string what, summary;
  std::vector<Choice> choices;
};
std::vector<ChoiceList> registries();

}  // namespace palpate::loop
