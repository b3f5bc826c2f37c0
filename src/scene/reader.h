#pragma once
#include <toml++/toml.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/keys.h"
#include "palpate/core/named_enum.h"
#include "palpate/scene/kinds.h"
#include "scene/toml_text.h"

/// Reader of TOML tables into plain specs by tables of keys.  A key table defines a scene table completely:
/// the names of its keys, their types, units, ranges, defaults and meaning, and whether they are required;
/// other keys are rejected with a suggestion of the nearest name.  `palpate list keys` prints it.
namespace palpate::scene {

/// Value to be read into a spec, with its labels in messages.
struct Value {
  const toml::node& node;
  std::string where;  ///< Label of the table: `body "ball": mesh`; empty at the top.
  std::string key;    ///< Name of the key: `radius_m`.
};

/// Returns a TOML value as a Setting; empty where it is of another type.
std::optional<Setting> setting_of(const toml::node& node);

/// Throws Error `LOCATION: where: what`.
[[noreturn]] void refuse(const std::string& location, const std::string& where, const std::string& what);

inline Range any() { return {}; }
inline Range positive(std::string_view remedy = {}) { return Range::positive(remedy); }
inline Range at_least(double low, std::string_view remedy = {}) { return Range::at_least(low, remedy); }
inline Range closed(double low, double high, std::string_view remedy = {}) {
  return Range::closed(low, high, remedy);
}
inline Range open(double low, double high, std::string_view remedy = {}) {
  return Range::open(low, high, remedy);
}

using Names = std::vector<std::string>;

double read_number(const Value& value, const Range& range);
int read_integer(const Value& value, const Range& range);
bool read_bool(const Value& value);
/// An empty list allows any text that is not empty.
std::string read_text(const Value& value, const Names& allowed);
Vec3 read_vec3(const Value& value, const Range& each);
std::vector<double> read_numbers(const Value& value, const Range& each);
std::vector<std::string> read_texts(const Value& value);
const toml::table& read_table_node(const Value& value);
std::vector<const toml::table*> read_table_array(const Value& value);

/// Returns the label of a table in messages: `body "ball"`, `contact between "ball" and "floor"`, `device:
/// keyframe[2]`.
std::string label(const std::string& where, const std::string& key, const toml::table& table,
                  std::optional<std::size_t> index);

/// Rejects keys that are not in `known`.
void refuse_unknown(const toml::table& table, const std::string& where, const Names& known);
/// Throws Error for a missing key, at the location of the table.
void refuse_missing(const toml::table& table, const std::string& where, const std::string& key);

/// Returns a spec's value as TOML; empty where no scene can express it.
inline std::string to_toml(double value) { return palpate::to_toml(value); }
inline std::string to_toml(int value) { return fmt::format("{}", value); }
inline std::string to_toml(bool value) { return value ? "true" : "false"; }
inline std::string to_toml(const Vec3& value) { return palpate::to_toml(Setting(value)); }
inline std::string to_toml(const std::string& value) { return value.empty() ? "" : '"' + value + '"'; }
inline std::string to_toml(const std::optional<double>& value) { return value ? to_toml(*value) : ""; }
template <NamedEnum E>
std::string to_toml(E value) {
  return to_toml(std::string(name_of(value)));
}
template <NamedEnum E>
std::string to_toml(const std::optional<E>& value) {
  return value ? to_toml(*value) : "";
}
template <class Item>
std::string to_toml(const std::vector<Item>& values) {
  std::string out;
  for (const Item& one : values) out += (out.empty() ? "" : ", ") + to_toml(one);
  return out.empty() ? "" : "[" + out + "]";
}

/// Returns the unit of a key: Pa for "_pa", Pa s/m for "_pa_s_m", ...; empty where the name ends in no unit.
std::string unit_of(const std::string& key);
std::string choices(const Names& names);  ///< Names in quotes: "a", "b".

/// Row of a key table: the only definition of a key.
template <class Spec>
struct Key {
  std::string name;
  std::function<void(const Value&, Spec&)> read;
  KeyRow row;                         ///< Documentation, without the name of the table.
  std::vector<KeyRow> children = {};  ///< For a table: its keys; their table names are relative to this key.
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

/// Returns the documentation of a table and of its subtables, with dotted names that begin with `table`.
template <class Spec>
std::vector<KeyRow> rows_of(const std::string& table, const KeyTable<Spec>& keys) {
  std::vector<KeyRow> rows;
  const auto add = [&](KeyRow row) {
    row.table = row.table.empty() || table.empty() ? table + row.table : table + "." + row.table;
    rows.push_back(std::move(row));
  };
  for (const auto& key : keys) {
    KeyRow row = key.row;
    row.required = key.required;
    if (key.required) row.fallback.clear(), row.is_value = false;
    add(std::move(row));
  }
  for (const auto& key : keys)
    for (const KeyRow& child : key.children) add(child);
  return rows;
}

/// Parses TOML text as one value and calls `use` with it; the value lives only during the call.
void with_value(const std::string& toml, const std::string& key,
                const std::function<void(const Value&)>& use);

/// Makes a key whose value goes into one member; its default is that of the member.
template <class Spec, class Member>
Key<Spec> member_key(const char* name, Member Spec::*member, std::function<Member(const Value&)> read,
                     const char* type, std::string range, const char* meaning) {
  Key<Spec> key{name, [=](const Value& v, Spec& spec) { spec.*member = read(v); }, {}};
  key.row = {.table = "",
             .name = name,
             .type = type,
             .unit = unit_of(name),
             .range = std::move(range),
             .fallback = to_toml(Spec{}.*member),
             .meaning = meaning,
             .users = {}};
  key.row.is_value = !key.row.fallback.empty();
  key.row.read_back = [=, read = key.read](const std::string& toml) {
    Spec spec{};
    with_value(toml, name, [&](const Value& v) { read(v, spec); });
    return to_toml(spec.*member);
  };
  return key;
}

/// Makes a key without a single member: with its reader, and its default in words.
template <class Spec>
Key<Spec> own_key(const char* name, std::function<void(const Value&, Spec&)> read, const char* type,
                  const char* fallback, const char* meaning) {
  Key<Spec> key{name, std::move(read), {}};
  key.row = {.table = "",
             .name = name,
             .type = type,
             .unit = unit_of(name),
             .range = "",
             .fallback = fallback,
             .meaning = meaning,
             .users = {}};
  return key;
}

/// Reads a table.  Unknown keys are reported first: a misspelt key is reported before the key that is missing
/// because of it.
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
/// Sets a default in words, for one that depends on other keys.
template <class Spec>
Key<Spec> unless(const char* words, Key<Spec> key) {
  key.row.fallback = words;
  key.row.is_value = false;
  return key;
}
/// Sets a unit that the name does not contain.
template <class Spec>
Key<Spec> in_unit(const char* unit, Key<Spec> key) {
  key.row.unit = unit;
  return key;
}

template <class Spec>
Key<Spec> number(const char* name, double Spec::*member, Range range, const char* meaning) {
  return member_key<Spec, double>(
      name, member, [=](const Value& v) { return read_number(v, range); }, "number", range.text(), meaning);
}
template <class Spec>
Key<Spec> number(const char* name, std::optional<double> Spec::*member, Range range, const char* meaning) {
  return member_key<Spec, std::optional<double>>(
      name, member, [=](const Value& v) { return read_number(v, range); }, "number", range.text(), meaning);
}
template <class Spec>
Key<Spec> integer(const char* name, int Spec::*member, Range range, const char* meaning) {
  return member_key<Spec, int>(
      name, member, [=](const Value& v) { return read_integer(v, range); }, "whole number", range.text(),
      meaning);
}
template <class Spec>
Key<Spec> boolean(const char* name, bool Spec::*member, const char* meaning) {
  return member_key<Spec, bool>(name, member, read_bool, "true or false", "", meaning);
}
template <class Spec>
Key<Spec> text(const char* name, std::string Spec::*member, Names allowed, const char* meaning) {
  return member_key<Spec, std::string>(
      name, member, [=](const Value& v) { return read_text(v, allowed); }, "text", choices(allowed), meaning);
}
/// Makes a key for an option: an enumeration, or an optional one without a default.
/// @param some  values that the key allows; empty: all
template <class Spec, NamedEnum E, class Member>
Key<Spec> option_key(const char* name, Member Spec::*member, const std::vector<E>& some,
                     const char* meaning) {
  const Names allowed = names_of_options(some);
  return member_key<Spec, Member>(
      name, member, [=](const Value& v) { return *value_named<E>(read_text(v, allowed)); }, "text",
      choices(allowed), meaning);
}
template <class Spec, NamedEnum E>
Key<Spec> option(const char* name, E Spec::*member, const char* meaning, const std::vector<E>& some = {}) {
  return option_key<Spec, E>(name, member, some, meaning);
}
template <class Spec, NamedEnum E>
Key<Spec> option(const char* name, std::optional<E> Spec::*member, const char* meaning) {
  return option_key<Spec, E>(name, member, {}, meaning);
}
template <class Spec>
Key<Spec> vec3(const char* name, Vec3 Spec::*member, Range each, const char* meaning) {
  return member_key<Spec, Vec3>(
      name, member, [=](const Value& v) { return read_vec3(v, each); }, "three numbers", each.text(),
      meaning);
}
template <class Spec>
Key<Spec> numbers(const char* name, std::vector<double> Spec::*member, Range each, const char* meaning) {
  return member_key<Spec, std::vector<double>>(
      name, member, [=](const Value& v) { return read_numbers(v, each); }, "list of numbers", each.text(),
      meaning);
}
template <class Spec>
Key<Spec> texts(const char* name, std::vector<std::string> Spec::*member, const char* meaning) {
  return member_key<Spec, std::vector<std::string>>(name, member, read_texts, "list of texts", "", meaning);
}

/// Makes the key [name], a table whose keys go into a separate spec.
template <class Spec, class Sub>
Key<Spec> table(const char* name, Sub Spec::*member, const KeyTable<Sub>& keys, const char* meaning) {
  Key<Spec> key = own_key<Spec>(
      name,
      [member, &keys](const Value& v, Spec& spec) {
        read_table(read_table_node(v), label(v.where, v.key, read_table_node(v), {}), keys, spec.*member);
      },
      "table", "", meaning);
  key.children = rows_of(name, keys);
  return key;
}
template <class Spec, class Sub>
Key<Spec> table(const char* name, std::optional<Sub> Spec::*member, const KeyTable<Sub>& keys,
                const char* meaning) {
  Key<Spec> key = own_key<Spec>(
      name,
      [member, &keys](const Value& v, Spec& spec) {
        read_table(read_table_node(v), label(v.where, v.key, read_table_node(v), {}), keys,
                   (spec.*member).emplace());
      },
      "table", "", meaning);
  key.children = rows_of(name, keys);
  return key;
}

/// Makes the key [name], a table whose keys go into the enclosing spec.
template <class Spec>
Key<Spec> group(const char* name, const KeyTable<Spec>& keys, const char* meaning) {
  Key<Spec> key = own_key<Spec>(
      name,
      [&keys](const Value& v, Spec& spec) {
        read_table(read_table_node(v), label(v.where, v.key, read_table_node(v), {}), keys, spec);
      },
      "table", "", meaning);
  key.children = rows_of(name, keys);
  return key;
}

/// Makes the key [[name]], one spec per table.
template <class Spec, class Sub>
Key<Spec> tables(const char* name, std::vector<Sub> Spec::*member, const KeyTable<Sub>& keys,
                 const char* meaning) {
  Key<Spec> key = own_key<Spec>(
      name,
      [member, &keys](const Value& v, Spec& spec) {
        for (const toml::table* one : read_table_array(v)) {
          Sub& sub = (spec.*member).emplace_back();
          read_table(*one, label(v.where, v.key, *one, (spec.*member).size() - 1), keys, sub);
        }
      },
      "tables", "", meaning);
  key.children = rows_of(name, keys);
  return key;
}

}  // namespace palpate::scene
