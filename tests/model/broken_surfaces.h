#pragma once
#include <functional>
#include <string>
#include <vector>

#include "model/make_model.h"

/// Defective surfaces and tetrahedra, with the expected outcome of each.
namespace broken {

using namespace palpate;

struct Entry {
  std::string name;
  std::function<model::Input()> make;
  /// "model", or words in the error message that state the defect; the message must also give a location and
  /// a remedy
  std::string expected;
  bool quick = true;  ///< part of the quick subset of every test run
  model::Options options = {};
  int tetrahedra = 1500;  ///< requested number, at least
};

std::vector<Entry> entries();

}  // namespace broken
