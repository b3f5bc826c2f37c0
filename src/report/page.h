#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "report/answer.h"

namespace palpate::report {

enum class RowMark { kNone, kGood, kBad, kFaint };

/// One self-contained HTML page: no external file.  Where it holds what a reader can sort, zoom or turn, it
/// holds the script for it (src/report/page) as well; without script all but the turning view is there.
/// It is well-formed XML too.  All text given is escaped here.
class Page {
 public:
  explicit Page(std::string title);

  Page& add_heading(const std::string& text, int level = 2);
  Page& add_paragraph(const std::string& text);
  Page& add_answer(const std::vector<Answer>& answers);
  /// Columns of numbers are set to the right.  `marks` colours rows; it is empty or has one mark a row.  A
  /// reader may sort it by any column: as numbers where each cell begins with one ("<= 0.12", "1.5 (1 to
  /// 2)").
  Page& add_table(const std::vector<std::string>& headers, const std::vector<std::vector<std::string>>& rows,
                  const std::string& caption = "", const std::vector<RowMark>& marks = {});
  using Facts = std::vector<std::pair<std::string, std::string>>;
  /// Name and value pairs, two columns without a header.
  Page& add_facts(const Facts& facts);
  /// Several such tables under small headings, side by side where there is room.
  Page& add_fact_groups(const std::vector<std::pair<std::string, Facts>>& groups);
  /// A chart: its SVG, for print and where there is no script, and its numbers (plot_json.h), from which the
  /// script draws it anew.
  Page& add_chart(const std::string& svg, const std::string& json, const std::string& caption);
  /// A view that turns and plays, from its JSON (surface_json.h); hidden where there is no script.
  Page& add_view(const std::string& json, const std::string& caption);
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

  /// What is added between these two is one of several results, its headings one level lower.
  Page& begin_part(const std::string& id, const std::string& title);
  Page& end_part();
  /// Links to the parts, each with what it answers first.
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
  int figures_ = 0;
  int level_ = 0;  ///< of the part, 0 or 1
  bool interacts_ = false, turns_ = false;
  std::vector<MissingFigure> missing_figures_;
};

/// Writes the page whole or not at all.
void write(const Page& page, const std::filesystem::path& path);

/// & < > " ' as entities; control characters that HTML forbids become U+FFFD.
std::string escape_html(const std::string& text);

}  // namespace palpate::report
