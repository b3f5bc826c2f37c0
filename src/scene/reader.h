#pragma once
#include <toml++/toml.h>

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/types.h"
#include "scene/document.h"

/// Reads TOML tables into plain specs by tables of keys.  A key table says everything about a scene table:
/// the names that may stand in it, their types, ranges and whether they must be there; what is not in it is
/// refused with the nearest name that is.
namespace palpate::scene {

/// A value on its way into a spec, and how messages speak of it.
struct Value {
  const toml::node& node;
  std::string where;  ///< `body "ball": mesh`; empty at the top
  std::string key;    ///< `radius_m`
};

/// throw Error `PLACE: where: what`.
[[noreturn]] void refuse(const std::string& place, const std::string& where, const std::string& what);

/// Values that a number may take, and what to do about one outside.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false, high_open = false;
  std::string remedy;
};
Range any();
Range positive(std::string remedy = "");
Range at_least(double low, std::string remedy = "");
Range closed(double low, double high, std::string remedy = "");
Range open(double low, double high, std::string remedy = "");

using Names = std::vector<std::string>;

double read_number(const Value& value, const Range& range);
int read_integer(const Value& value, const Range& range);
bool read_bool(const Value& value);
std::string read_text(const Value& value, const Names& allowed);  ///< no names: any text that is not empty
Vec3 read_vec3(const Value& value, const Range& each);
std::vector<double> read_numbers(const Value& value, const Range& each);
std::vector<std::string> read_texts(const Value& value);
const toml::table& read_table_node(const Value& value);
std::vector<const toml::table*> read_table_array(const Value& value);

/// `body "ball"`, `contact between "ball" and "floor"`, `device: keyframe[2]`: how messages speak of a table.
std::string label(const std::string& where, const std::string& key, const toml::table& table,
                  std::optional<std::size_t> index);

void refuse_unknown(const toml::table& table, const std::string& where, const Names& known);
void refuse_missing(const toml::table& table, const std::string& where, const std::string& key);

template <class Spec>
struct Key {
  std::string name;
  std::function<void(const Value&, Spec&)> read;
  Names children = {};  ///< dotted names of the keys inside a table
  bool required = false;
};

template <class Spec>
using KeyTable = std::vector<Key<Spec>>;

template <class Spec>
Names names_of(const KeyTable<Spec>& keys) {
  Names names;
  for (const auto& key : keys) names.push_back(key.name);
  return names;
}

/// All names, those inside tables included: `mesh`, `mesh.file`, ...
template <class Spec>
Names dotted_names(const KeyTable<Spec>& keys) {
  Names names;
  for (const auto& key : keys) {
    names.push_back(key.name);
    for (const auto& child : key.children) names.push_back(key.name + "." + child);
  }
  return names;
}

/// A misspelt key is reported before the key that it leaves missing.
template <class Spec>
void read_table(const toml::table& table, const std::string& where, const KeyTable<Spec>& keys, Spec& spec) {
  refuse_unknown(table, where, names_of(keys));
  for (const auto& key : keys)
    if (key.required && !table.contains(key.name)) refuse_missing(table, where, key.name);
  for (const auto& key : keys)
    if (const toml::node* node = table.get(key.name)) key.read(Value{*node, where, key.name}, spec);
}

template <class Spec>
Key<Spec> required(Key<Spec> key) {
  key.required = true;
  return key;
}

template <class Spec>
Key<Spec> number(const char* name, double Spec::*member, Range range = any()) {
  return {name, [=](const Value& v, Spec& spec) { spec.*member = read_number(v, range); }};
}
template <class Spec>
Key<Spec> number(const char* name, std::optional<double> Spec::*member, Range range = any()) {
  return {name, [=](const Value& v, Spec& spec) { spec.*member = read_number(v, range); }};
}
template <class Spec>
Key<Spec> integer(const char* name, int Spec::*member, Range range = any()) {
  return {name, [=](const Value& v, Spec& spec) { spec.*member = read_integer(v, range); }};
}
template <class Spec>
Key<Spec> boolean(const char* name, bool Spec::*member) {
  return {name, [=](const Value& v, Spec& spec) { spec.*member = read_bool(v); }};
}
template <class Spec>
Key<Spec> text(const char* name, std::string Spec::*member, Names allowed = {}) {
  return {name, [=](const Value& v, Spec& spec) { spec.*member = read_text(v, allowed); }};
}
template <class Spec>
Key<Spec> vec3(const char* name, Vec3 Spec::*member, Range each = any()) {
  return {name, [=](const Value& v, Spec& spec) { spec.*member = read_vec3(v, each); }};
}
template <class Spec>
Key<Spec> numbers(const char* name, std::vector<double> Spec::*member, Range each = any()) {
  return {name, [=](const Value& v, Spec& spec) { spec.*member = read_numbers(v, each); }};
}

template <class Spec>
Key<Spec> texts(const char* name, std::vector<std::string> Spec::*member) {
  return {name, [=](const Value& v, Spec& spec) { spec.*member = read_texts(v); }};
}

/// [name] whose keys go into a spec of its own.
template <class Spec, class Sub>
Key<Spec> table(const char* name, Sub Spec::*member, const KeyTable<Sub>& keys) {
  return {name,
          [member, &keys](const Value& v, Spec& spec) {
            read_table(read_table_node(v), label(v.where, v.key, read_table_node(v), {}), keys, spec.*member);
          },
          dotted_names(keys)};
}
template <class Spec, class Sub>
Key<Spec> table(const char* name, std::optional<Sub> Spec::*member, const KeyTable<Sub>& keys) {
  return {name,
          [member, &keys](const Value& v, Spec& spec) {
            read_table(read_table_node(v), label(v.where, v.key, read_table_node(v), {}), keys,
                       (spec.*member).emplace());
          },
          dotted_names(keys)};
}

/// [name] whose keys go into the enclosing spec.
template <class Spec>
Key<Spec> group(const char* name, const KeyTable<Spec>& keys) {
  return {name,
          [&keys](const Value& v, Spec& spec) {
            read_table(read_table_node(v), label(v.where, v.key, read_table_node(v), {}), keys, spec);
          },
          dotted_names(keys)};
}

/// [[name]], one spec a table.
template <class Spec, class Sub>
Key<Spec> tables(const char* name, std::vector<Sub> Spec::*member, const KeyTable<Sub>& keys) {
  return {name,
          [member, &keys](const Value& v, Spec& spec) {
            for (const toml::table* one : read_table_array(v)) {
              Sub& sub = (spec.*member).emplace_back();
              read_table(*one, label(v.where, v.key, *one, (spec.*member).size() - 1), keys, sub);
            }
          },
          dotted_names(keys)};
}

}  // namespace palpate::scene
