#include "scene/reader.h"

#include <cmath>

namespace palpate::scene {
namespace {

/// A node as messages show it, near to how a person wrote it.
std::string shown(const toml::node& node) {
  if (const auto* text = node.as_string())
    return text->get().size() <= 60 ? '"' + text->get() + '"' : "a longer string";
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto* truth = node.as_boolean()) return truth->get() ? "true" : "false";
  const toml::array* array = node.as_array();
  if (!array) return node.is_table() ? "a table" : "a date or time";
  if (array->size() > 6) return fmt::format("a list of {}", array->size());
  std::string text;
  for (const toml::node& one : *array)
    text += (text.empty() ? "" : ", ") + (one.is_array() ? std::string("[...]") : shown(one));
  return "[" + text + "]";
}

/// `part` is the value itself, or the element of it that is at fault: the message shows the whole value, at
/// the part's place.
[[noreturn]] void refuse_value(const Value& v, const std::string& must, const toml::node* part = nullptr) {
  refuse(place((part ? *part : v.node).source()), v.where,
         fmt::format("{} = {} {}", v.key, shown(v.node), must));
}

std::string bounds(const Range& r) {
  if (std::isinf(r.high)) {
    if (r.low == 0.0 && r.low_open) return "must be positive";
    return r.low == 0.0 ? "must not be negative" : fmt::format("must be at least {}", r.low);
  }
  return fmt::format("must lie in {}{}, {}{}", r.low_open ? '(' : '[', r.low, r.high,
                     r.high_open ? ')' : ']');
}

bool inside(double x, const Range& r) {
  return (r.low_open ? x > r.low : x >= r.low) && (r.high_open ? x < r.high : x <= r.high);
}

/// One finite number within a range.  Whole numbers are numbers too; NaN and infinity, which TOML can spell,
/// are not.
double number_in(const Value& v, const toml::node& node, const Range& range) {
  if (!node.is_number()) refuse_value(v, "must be a number", &node);
  const double x = *node.value<double>();
  if (!std::isfinite(x)) refuse_value(v, "must be a finite number", &node);
  if (!inside(x, range))
    refuse_value(v, bounds(range) + (range.remedy.empty() ? "" : "; " + range.remedy), &node);
  return x;
}

}  // namespace

void refuse(const std::string& place, const std::string& where, const std::string& what) {
  fail("{}: {}{}{}", place, where, where.empty() ? "" : ": ", what);
}

Range any() { return {}; }
Range positive(std::string remedy) { return {.low = 0.0, .low_open = true, .remedy = std::move(remedy)}; }
Range at_least(double low, std::string remedy) { return {.low = low, .remedy = std::move(remedy)}; }
Range closed(double low, double high, std::string remedy) {
  return {.low = low, .high = high, .remedy = std::move(remedy)};
}
Range open(double low, double high, std::string remedy) {
  return {.low = low, .high = high, .low_open = true, .high_open = true, .remedy = std::move(remedy)};
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
  refuse(place(v.node.source()), v.where,
         fmt::format("{} must be one table: write [{}]{}", v.key, v.key,
                     many ? " once, with single brackets" : ""));
}

std::vector<const toml::table*> read_table_array(const Value& v) {
  if (!v.node.is_array_of_tables())
    refuse(place(v.node.source()), v.where,
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
      refuse(place(key.source()), where,
             fmt::format("unknown key \"{}\"{}", key.str(), suggestion(key.str(), known)));
  }
}

void refuse_missing(const toml::table& table, const std::string& where, const std::string& key) {
  refuse(place(table.source()), where, fmt::format("{} is missing and has no default", key));
}

}  // namespace palpate::scene
