#pragma once
#include <string>
#include <string_view>

#include "palpate/core/error.h"

namespace palpate::mesh {

/// Syntax options of a text file.
struct TextForm {
  char comment = '\0';     ///< starts a comment up to the end of the line; '\0': no comments
  bool continued = false;  ///< a backslash at a line's end joins the next line, except after a comment
};

/// Text file read line by line and word by word; every error message contains FILE:LINE.  The whole file is
/// held in memory, so that a count in a header can be compared with the data present before anything is
/// allocated for it.
class TextFile {
 public:
  /// @throws Error when the file cannot be read
  explicit TextFile(const std::string& path, TextForm form = {});

  bool next_line();  ///< advances to the next line that has a word; false at the end of the file
  void require_line(std::string_view what);
  std::string_view word();  ///< next word of this line; empty if none is left
  std::string_view rest();  ///< remainder of this line, without blanks around it
  bool at_end_of_line();

  double real(std::string_view what);  ///< reads a finite number
  long integer(std::string_view what);
  /// Reads a count of entries in the rest of this file, of at least two bytes each.
  /// @throws Error for a negative count, or more entries than the rest can hold
  int count(std::string_view what);
  void require_end_of_line();

  /// Adds a subject to error messages up to the next line: `FILE:LINE: node 12: ...`.
  void about(std::string_view noun, long number) { noun_ = noun, number_ = number; }

  const std::string& path() const { return path_; }
  int line() const { return line_number_; }  ///< the first line, if several are joined

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
  std::size_t next_ = 0;             // start of the next line in text_
  std::string_view rest_;            // remainder of the current line
  int line_number_ = 0, lines_ = 0;  // the current line; all lines read
  std::string_view noun_;            // literals only
  long number_ = 0;
};

/// Returns a word for a message: at most 40 characters, unprintable ones as '?'.
std::string printable(std::string_view word);

}  // namespace palpate::mesh
