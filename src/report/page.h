#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "report/answer.h"
#include "report/table.h"

namespace palpate::report {

/// Colour of a table row.
enum class RowMark { kNone, kGood, kBad, kFaint };

/// Self-contained HTML page without external files. A page with content that can be sorted, zoomed or rotated
/// includes the script for it (src/report/page); without scripts everything except charts and the rotating
/// view is shown. The page is also well-formed XML. All text passed to it is escaped here.
class Page {
 public:
  explicit Page(std::string title);

  Page& add_heading(const std::string& text, int level = 2);
  Page& add_paragraph(const std::string& text);
  Page& add_answer(const std::vector<Answer>& answers);
  /// Adds a table. Columns of numbers are aligned to the right. `marks` colours rows; it is empty or has one
  /// mark per row. The reader can sort the table by any column: as numbers if each cell begins with a number
  /// ("<= 0.12", "1.5 (1 to 2)").
  Page& add_table(const std::vector<std::string>& headers, const Rows& rows, const std::string& caption = "",
                  const std::vector<RowMark>& marks = {});
  using Facts = std::vector<std::pair<std::string, std::string>>;
  /// Adds name and value pairs as two columns without a header.
  Page& add_facts(const Facts& facts);
  /// Adds several such tables under small headings, side by side if there is room.
  Page& add_fact_groups(const std::vector<std::pair<std::string, Facts>>& groups);
  /// Adds a chart from its JSON (plot.h), which the script draws; without script, a note that its values are
  /// in `file`.
  Page& add_chart(const std::string& json, const std::string& file, const std::string& caption);
  /// Adds a view that rotates and plays, from its JSON (surface_json.h); hidden without script.
  Page& add_view(const std::string& json, const std::string& caption);
  /// Adds an embedded PNG file.  @throws Error if it cannot be read or is not a PNG
  Page& add_png(const std::filesystem::path& png, const std::string& caption);
  /// Adds a paragraph with the reason in place of a figure that could not be drawn.
  Page& add_missing_figure(const std::string& caption, const std::string& why);
  /// Adds HTML that the caller has made well-formed and escaped.
  Page& add_fragment(const std::string& html);
  Page& add_code(const std::string& text);

  /// Shows a picture and the content after it, added between these two calls, side by side if there is room.
  Page& begin_lead();
  Page& end_lead();
  /// Shows the figures added between these two calls side by side if there is room.
  Page& begin_multiples();
  Page& end_multiples();
  /// Folds the content added between these two calls under a line of text until the reader opens it.
  Page& begin_details(const std::string& summary);
  Page& end_details();

  /// Marks the content added between these two calls as one of several results; its headings are one level
  /// lower.
  Page& begin_part(const std::string& id, const std::string& title);
  Page& end_part();
  /// Link to a part, with its first answer.
  struct Link {
    std::string id, title, answer;
  };
  Page& add_contents(const std::vector<Link>& links);

  std::string html() const;
  struct MissingFigure {
    std::string caption, why;
  };
  const std::vector<MissingFigure>& missing_figures() const { return missing_figures_; }

 private:
  std::string title_;
  std::string body_;
  int level_ = 0;  ///< Heading offset: 1 within a part, else 0
  bool interacts_ = false, turns_ = false;
  std::vector<MissingFigure> missing_figures_;
};

/// Writes the page to a file, atomically.
void write(const Page& page, const std::filesystem::path& path);

/// Returns the text with & < > " ' as entities; control characters that HTML forbids become U+FFFD.
std::string escape_html(const std::string& text);

}  // namespace palpate::report
