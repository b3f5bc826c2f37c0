#include "scene/reader.h"

#include <cmath>

#include "core/units.h"

namespace palpate::scene {
namespace {

/// Throws Error for a value.  `part` is the faulty element, or null for the value itself: the message shows
/// the whole value, at the location of the part.
[[noreturn]] void refuse_value(const Value& v, const std::string& must, const toml::node* part = nullptr) {
  refuse(location((part ? *part : v.node).source()), v.where,
         fmt::format("{} = {} {}", v.key, shown(v.node), must));
}

/// Returns a number as double.  toml++ converts no whole number that has no exact double; parse_document()
/// has rejected those.
/// @pre node.is_number()
double double_of(const toml::node& node) {
  const auto* whole = node.as_integer();
  return whole ? static_cast<double>(whole->get()) : node.as_floating_point()->get();
}

/// Reads one finite number within a range.  Whole numbers are accepted; NaN and infinity, which TOML can
/// express, are not.
double number_in(const Value& v, const toml::node& node, const Range& range) {
  if (!node.is_number()) refuse_value(v, "must be a number", &node);
  const double x = double_of(node);
  if (!std::isfinite(x)) refuse_value(v, "must be a finite number", &node);
  if (!range.holds(x)) refuse_value(v, range.demand(), &node);
  return x;
}

}  // namespace

void refuse(const std::string& location, const std::string& where, const std::string& what) {
  fail("{}: {}{}{}", location, where, where.empty() ? "" : ": ", what);
}

std::optional<Setting> setting_of(const toml::node& node) {
  if (const auto* flag = node.as_boolean()) return flag->get();
  if (node.is_number()) return double_of(node);
  if (const auto* text = node.as_string()) return text->get();
  const toml::array* array = node.as_array();
  if (!array || array->size() != 3) return {};
  Vec3 out;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!array->get(i)->is_number()) return {};
    out[static_cast<Eigen::Index>(i)] = double_of(*array->get(i));
  }
  return Setting(out);
}

std::string unit_of(const std::string& key) { return split_unit(key).unit; }

std::string choices(const Names& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "\"" : ", \"") + name + '"';
  return out;
}

void with_value(const std::string& toml, const std::string& key,
                const std::function<void(const Value&)>& use) {
  const toml::table parsed = toml::parse(key + " = " + toml, std::string("default"));
  use(Value{*parsed.get(key), "", key});
}

double read_number(const Value& v, const Range& range) { return number_in(v, v.node, range); }

int read_integer(const Value& v, const Range& range) {
  if (!v.node.is_integer()) refuse_value(v, "must be a whole number");
  const double x = number_in(v, v.node, range);
  if (std::abs(x) > std::numeric_limits<int>::max())
    refuse_value(v, fmt::format("must not exceed {}", std::numeric_limits<int>::max()));
  return static_cast<int>(x);
}

bool read_bool(const Value& v) {
  if (!v.node.is_boolean()) refuse_value(v, "must be true or false");
  return *v.node.value<bool>();
}

std::string read_text(const Value& v, const Names& allowed) {
  if (!v.node.is_string()) refuse_value(v, "must be a string in quotes");
  std::string text = *v.node.value<std::string>();
  if (text.empty()) refuse_value(v, "must not be empty");
  for (const std::string& name : allowed)
    if (name == text) return text;
  if (!allowed.empty()) refuse_value(v, "is not known" + suggestion(text, allowed));
  return text;
}

Vec3 read_vec3(const Value& v, const Range& each) {
  const toml::array* array = v.node.as_array();
  if (!array || array->size() != 3) refuse_value(v, "must be three numbers, [x, y, z]");
  Vec3 out;
  for (std::size_t i = 0; i < 3; ++i) out[static_cast<Eigen::Index>(i)] = number_in(v, *array->get(i), each);
  return out;
}

std::vector<double> read_numbers(const Value& v, const Range& each) {
  const toml::array* array = v.node.as_array();
  if (!array) refuse_value(v, "must be a list of numbers, [a, b, ...]");
  std::vector<double> out;
  for (const toml::node& node : *array) out.push_back(number_in(v, node, each));
  return out;
}

std::vector<std::string> read_texts(const Value& v) {
  const toml::array* array = v.node.as_array();
  if (!array) refuse_value(v, "must be a list of strings, [\"a\", \"b\"]");
  std::vector<std::string> out;
  for (const toml::node& node : *array) out.push_back(read_text(Value{node, v.where, v.key}, {}));
  return out;
}

const toml::table& read_table_node(const Value& v) {
  if (const toml::table* found = v.node.as_table()) return *found;
  const bool many = v.node.is_array_of_tables();
  refuse(location(v.node.source()), v.where,
         fmt::format("{} must be one table: write [{}]{}", v.key, v.key,
                     many ? " once, with single brackets" : ""));
}

std::vector<const toml::table*> read_table_array(const Value& v) {
  if (!v.node.is_array_of_tables())
    refuse(location(v.node.source()), v.where,
           fmt::format("{} must be a list of tables: write [[{}]] with double brackets", v.key, v.key));
  std::vector<const toml::table*> out;
  for (const toml::node& node : *v.node.as_array()) out.push_back(node.as_table());
  return out;
}

std::string label(const std::string& where, const std::string& key, const toml::table& table,
                  std::optional<std::size_t> index) {
  std::string own = key;
  const auto name = index ? table["name"].value<std::string>() : std::nullopt;
  const auto first = table["between"][0].value<std::string>(),
             second = table["between"][1].value<std::string>();
  if (name && !name->empty())
    own = fmt::format("{} \"{}\"", key, *name);
  else if (index && first && second)
    own = fmt::format("{} between \"{}\" and \"{}\"", key, *first, *second);
  else if (index)
    own = fmt::format("{}[{}]", key, *index);
  return where.empty() ? own : where + ": " + own;
}

void refuse_unknown(const toml::table& table, const std::string& where, const Names& known) {
  for (const auto& [key, node] : table) {
    bool found = false;
    for (const std::string& name : known) found = found || name == key.str();
    if (!found)
      refuse(location(key.source()), where,
             fmt::format("unknown key \"{}\"{}", key.str(), suggestion(key.str(), known)));
  }
}

void refuse_missing(const toml::table& table, const std::string& where, const std::string& key) {
  refuse(location(table.source()), where, fmt::format("{} is missing and has no default", key));
}

}  // namespace palpate::scene
