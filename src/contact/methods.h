#pragma once
#include <string>
#include <vector>

#include "palpate/core/registry.h"

/// Registries of the names that a [[contact]] of a scene accepts, with the keys that each uses.
namespace palpate::contact {

/// Method that finds gaps, and thereby their location: vertices or material points.
struct MethodEntry {
  std::string name, summary;
  std::vector<PartKey> keys = {};
};
/// Returns the methods, in the order of `palpate list`.
const std::vector<MethodEntry>& method_registry();

/// Removed or never implemented method name, and the continuation of the error message: which method to use
/// instead.
struct AbsentMethod {
  std::string name, answer;
};
/// Returns the names that get such a message.
const std::vector<AbsentMethod>& absent_methods();

/// Checks that a method is registered.
/// @throws Error for a name that is not in the registry: lists the available names, and which one to use
void check_method(const std::string& method, const std::string& where);

/// Meaning of the contact springs: per area, or per point.
struct SpringEntry {
  std::string name, summary;
  std::vector<PartKey> keys = {};
};
/// Returns the spring types.
const std::vector<SpringEntry>& spring_registry();

/// Pressure law: pressure as a function of depth and its rate.
struct LawEntry {
  std::string name, summary;
  std::vector<PartKey> keys = {};
};
/// Returns the pressure laws.
const std::vector<LawEntry>& law_registry();

}  // namespace palpate::contact
