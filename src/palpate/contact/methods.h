#pragma once
#include <string>
#include <vector>

#include "palpate/core/registry.h"

/// Names that a [[contact]] of a scene knows, with the keys that each uses.
namespace palpate::contact {

/// How gaps are found, and with it where: at vertices, or at material points.
struct MethodEntry {
  std::string name, summary;
  std::vector<PartKey> keys = {};
};
const std::vector<MethodEntry>& method_registry();

/// Names that are no methods, planned ones among them, and what a message says of each: which method to take.
struct AbsentMethod {
  std::string name, answer;
};
const std::vector<AbsentMethod>& absent_methods();

/// @throws Error for a name that is not in the registry: which there are, and which one to take
void check_method(const std::string& method, const std::string& where);

/// What the springs stand for: area, or each point for itself.
struct SpringEntry {
  std::string name, summary;
  std::vector<PartKey> keys = {};
};
const std::vector<SpringEntry>& spring_registry();

/// Pressure by depth and its rate.
struct LawEntry {
  std::string name, summary;
  std::vector<PartKey> keys = {};
};
const std::vector<LawEntry>& law_registry();

}  // namespace palpate::contact
