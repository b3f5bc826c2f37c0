#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Row of a CSV text.
struct CsvRow {
  long line = 0;  ///< Line in which the row begins, counted from 1.
  std::vector<std::string> cells;
};

/// Reads the rows of a CSV text in any of the usual dialects; empty lines are skipped.
///
/// The delimiter is the comma, semicolon or tab, whichever is most frequent outside quotes in the first line,
/// or the one that a first line "sep=;" specifies.  Quotes follow RFC 4180.  Lines end in LF, CR LF or CR.  A
/// UTF-8 byte-order mark is skipped.  Blanks around an unquoted cell are removed.
/// @param path  for messages
/// @throws Error for an unclosed quote, and for text that is not UTF-8: UTF-16, zero bytes
std::vector<CsvRow> read_csv_text(std::string_view text, const std::string& path);

/// Reads a whole cell as a number: "1.5", "+1.0e-03", "nan", and with a decimal comma "1,5".  Returns false
/// where it is none; `out` is then unchanged.
bool read_csv_number(std::string_view cell, double& out);

}  // namespace palpate
