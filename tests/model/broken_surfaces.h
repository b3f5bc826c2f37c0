#pragma once
#include <functional>
#include <string>
#include <vector>

#include "palpate/model/make_model.h"

/// Surfaces and tetrahedra that no one cleaned up, and what is to become of each.
namespace broken {

using namespace palpate;

struct Entry {
  std::string name;
  std::function<model::Input()> make;
  /// "model", or words that the refusal holds: what is wrong; it must also name a place and what to do
  std::string expected;
  bool quick = true;  ///< is in the subset that every run makes
  model::Options options = {};
  int tetrahedra = 1500;  ///< at least
};

std::vector<Entry> entries();

}  // namespace broken
