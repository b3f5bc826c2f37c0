#pragma once
#include <string>
#include <string_view>

#include "palpate/core/error.h"

namespace palpate::mesh {

struct TextForm {
  char comment = '\0';     ///< from it on, a line is ignored; '\0': no comments
  bool continued = false;  ///< a backslash at a line's end joins the next line, except after a comment
};

/// A text file read line by line and word by word; every error message carries FILE:LINE.  Holds the whole
/// file in memory, so that a count in a header can be compared with what is really there before anything is
/// allocated for it.
class TextFile {
 public:
  /// @throws Error when the file cannot be read
  explicit TextFile(const std::string& path, TextForm form = {});

  bool next_line();  ///< goes to the next line that has a word; false at the end of the file
  void require_line(std::string_view what);
  std::string_view word();  ///< next word of this line, empty when there is none left
  std::string_view rest();  ///< what is left of this line, without blanks around it
  bool at_end_of_line();

  double real(std::string_view what);  ///< a finite number
  long integer(std::string_view what);
  /// A count of entries that stand in the rest of this file, at least two bytes each: refused when they
  /// cannot.
  int count(std::string_view what);
  void require_end_of_line();

  /// Until the next line, error messages name their subject: `FILE:LINE: node 12: ...`.
  void about(std::string_view noun, long number) { noun_ = noun, number_ = number; }

  const std::string& path() const { return path_; }
  int line() const { return line_number_; }  ///< the first one, where several are joined

  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) const {
    const std::string subject = noun_.empty() ? "" : fmt::format("{} {}: ", noun_, number_);
    palpate::fail("{}:{}: {}{}", path_, line_number_, subject,
                  fmt::format(format, std::forward<Args>(args)...));
  }

 private:
  std::string_view required_word(std::string_view what);

  std::size_t end_of_line(std::size_t from, int& lines);

  std::string path_, text_;
  TextForm form_;
  std::size_t next_ = 0;             // where the next line starts in text_
  std::string_view rest_;            // of the current line
  int line_number_ = 0, lines_ = 0;  // the current one, and all that were read
  std::string_view noun_;            // literals only
  long number_ = 0;
};

/// A word of a file as a message can show it: at most 40 characters, the unprintable ones as '?'.
std::string printable(std::string_view word);

}  // namespace palpate::mesh
