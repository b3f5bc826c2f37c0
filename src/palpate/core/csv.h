#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// One row of a CSV text.
struct CsvRow {
  long line = 0;  ///< where it begins, counted from 1
  std::vector<std::string> cells;
};

/// The rows of a CSV text in any of the usual dialects, empty lines left out.
///
/// Cells are separated by the commas, semicolons or tabs of the first line, whichever it has most of outside
/// quotes, or as its "sep=;" says.  Quotes are those of RFC 4180.  Lines end in LF, CR LF or CR.  A UTF-8
/// byte-order mark is left out.  Blanks around a cell without quotes do not belong to it.
/// @param path  for messages
/// @throws Error for a quote that is never closed, and for what is no text in UTF-8: UTF-16, bytes of zero
std::vector<CsvRow> read_csv_text(std::string_view text, const std::string& path);

/// Reads a whole cell as a number: "1.5", "+1.0e-03", "nan", and with a decimal comma "1,5".  False where it
/// is none; `out` stays then.
bool read_csv_number(std::string_view cell, double& out);

}  // namespace palpate
