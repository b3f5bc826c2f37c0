#include "scene/toml_bounds.h"

#include "core/printable.h"
#include "core/whole_number.h"
#include "palpate/core/error.h"
#include "scene/toml_text.h"

namespace palpate::scene {
namespace {

/// Scans the text once, as a lexer of TOML would: comments, four kinds of strings, brackets and keys.
/// Invalid TOML is left to the parser to reject.
class BoundsCheck {
 public:
  BoundsCheck(const std::string& text, const std::string& from) : text_(text), from_(from) {}

  void run() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#')
        skip_comment();
      else if (c == '"' || c == '\'')
        skip_string(c);
      else
        take(c);
    }
  }

 private:
  bool starts_with(const char* what, std::size_t at) const { return text_.compare(at, 3, what) == 0; }

  void take(char c) {
    ++at_;
    if (c == '\n') return end_line();
    if (c == '[' && line_is_blank_ && open_.empty()) return begin_header();
    if (c != ' ' && c != '\t') line_is_blank_ = false;
    if (in_header_) return c == '.' ? count_dot() : count_key(1);
    switch (c) {
      case '[':
      case '{': return open(c);
      case ']':
      case '}': return close();
      case ',': return begin_key(!open_.empty() && open_.back() == '{');
      case '=': return begin_key(false);
      case '.': return count_dot();
      default: count_key(1);
    }
  }

  void end_line() {
    ++line_;
    line_is_blank_ = true;
    in_header_ = false;
    if (open_.empty()) begin_key(true);
  }

  void begin_header() {
    in_header_ = true;
    line_is_blank_ = false;
    begin_key(true);
  }

  void open(char bracket) {
    open_ += bracket;
    if (open_.size() > kMostNested) refuse(fmt::format("lists and tables nest deeper than {}", kMostNested));
    begin_key(bracket == '{');
  }

  void close() {
    if (!open_.empty()) open_.pop_back();
    in_key_ = false;
  }

  void begin_key(bool key) {
    in_key_ = key;
    dots_ = 0;
    key_bytes_ = 0;
  }

  void count_dot() {
    if (in_key_ && ++dots_ >= kMostNested) refuse(fmt::format("a key has more than {} parts", kMostNested));
    count_key(1);
  }

  void count_key(std::size_t bytes) {
    if (in_key_ && (key_bytes_ += bytes) > kLongestKey)
      refuse(fmt::format("a key is longer than {} bytes", kLongestKey));
  }

  void skip_comment() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }

  /// Skips a string; a single-line string ends with the line at the latest, closed or not.
  void skip_string(char quote) {
    line_is_blank_ = false;
    const std::size_t first = at_;
    const char triple[] = {quote, quote, quote, '\0'};
    const bool many_lines = starts_with(triple, at_);
    at_ += many_lines ? 3 : 1;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '\n' && !many_lines) break;
      if (c == '\n') ++line_;
      if (c == '\\' && quote == '"' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n') {
        at_ += 2;
        continue;
      }
      const bool ends = c == quote && (!many_lines || starts_with(triple, at_));
      at_ += ends && many_lines ? 3 : 1;
      if (ends) break;
    }
    count_key(at_ - first);
  }

  [[noreturn]] void refuse(const std::string& what) const {
    const std::string place = from_.starts_with("--set ") ? from_ : fmt::format("{}:{}", from_, line_);
    fail("{}: {}; no key of palpate has this form", place, what);
  }

  const std::string& text_;
  const std::string& from_;
  std::size_t at_ = 0, key_bytes_ = 0;
  int line_ = 1, dots_ = 0;
  bool line_is_blank_ = true;  ///< The current line so far.
  bool in_header_ = false, in_key_ = true;
  std::string open_;  ///< Open brackets of lists and inline tables.
};

}  // namespace

void check_bounds(const std::string& text, const std::string& from) { BoundsCheck(text, from).run(); }

namespace {
/// Returns the fault of one value, as a text to follow its key; empty for none.
std::string fault_of(const toml::node& node) {
  if (const auto* number = node.as_integer(); number && beyond_whole(number->get()))
    return fmt::format("= {} {}", number->get(), kWholeDemand);
  if (const auto* text = node.as_string();
      text && (!is_printable(text->get()) || text->get().find('\n') != std::string::npos))
    return fmt::format("= {} must be one line without control characters", shown(node));
  return {};
}

void check_node(const toml::node& node, std::string_view key) {
  if (const std::string fault = fault_of(node); !fault.empty())
    fail("{}: {} {}", location(node.source()), key, fault);
  if (const toml::array* array = node.as_array())
    for (const toml::node& one : *array) check_node(one, key);
  if (const toml::table* table = node.as_table())
    for (const auto& [name, one] : *table) check_node(one, name.str());
}
}  // namespace

void check_values(const toml::table& root) { check_node(root, ""); }

}  // namespace palpate::scene
