#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace palpate::report {

enum class RowMark { kNone, kGood, kBad, kFaint };

/// One self-contained HTML page: no script, no external file.
/// It is well-formed XML too.  All text given is escaped here.
class Page {
 public:
  explicit Page(std::string title);

  Page& add_heading(const std::string& text, int level = 2);
  Page& add_paragraph(const std::string& text);
  /// Columns of numbers are set to the right.  `marks` colours rows; it is empty or has one mark a row.
  Page& add_table(const std::vector<std::string>& headers, const std::vector<std::vector<std::string>>& rows,
                  const std::string& caption = "", const std::vector<RowMark>& marks = {});
  using Facts = std::vector<std::pair<std::string, std::string>>;
  /// Name and value pairs, two columns without a header.
  Page& add_facts(const Facts& facts);
  /// Several such tables under small headings, side by side where there is room.
  Page& add_fact_groups(const std::vector<std::pair<std::string, Facts>>& groups);
  /// An SVG document, inlined; its black follows the page's text colour (dark mode), its ids are made unique.
  Page& add_svg(const std::string& svg, const std::string& caption);
  /// A PNG file, embedded.  Throws Error when it cannot be read or is not a PNG.
  Page& add_png(const std::filesystem::path& png, const std::string& caption);
  /// A paragraph in place of a figure that could not be drawn, with the reason.
  Page& add_missing_figure(const std::string& caption, const std::string& why);
  /// Ready HTML, well-formed and escaped by the caller.
  Page& add_fragment(const std::string& html);
  Page& add_code(const std::string& text);

  /// Figures that are added between these two stand side by side where there is room.
  Page& begin_multiples();
  Page& end_multiples();
  /// Content that is added between these two is folded away under a line of text until the reader opens it.
  Page& begin_details(const std::string& summary);
  Page& end_details();

  std::string html() const;
  struct MissingFigure {
    std::string caption, why;
  };
  const std::vector<MissingFigure>& missing_figures() const { return missing_figures_; }

 private:
  std::string title_;
  std::string body_;
  int figures_ = 0;
  std::vector<MissingFigure> missing_figures_;
};

/// Writes the page whole or not at all.
void write(const Page& page, const std::filesystem::path& path);

/// & < > " ' as entities; control characters that HTML forbids become U+FFFD.
std::string escape_html(const std::string& text);

}  // namespace palpate::report
