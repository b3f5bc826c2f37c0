#include "report/run_report.h"

#include <fmt/format.h>

#include <map>

#include "core/missing_outputs.h"
#include "palpate/core/error.h"
#include "result.h"
#include "sections.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

RunReport written(const Page& page, const fs::path& path) {
  write(page, path);
  return {path, page.missing_figures()};
}

}  // namespace

RunReport write_run_report(const fs::path& dir) { return write_report({dir}, dir / "report.html"); }

RunReport write_report(const std::vector<fs::path>& dirs, const fs::path& path, const FirstView& view) {
  PALPATE_CHECK(!dirs.empty(), "a report needs at least one directory");
  std::vector<Result> results;
  for (const fs::path& dir : dirs) results.push_back(open_result(dir));
  if (results.size() == 1) {
    Page page(results[0].title());
    add_result(page, results[0], view);
    return written(page, path);
  }
  Page page(fmt::format("palpate: {} results", results.size()));
  std::vector<Page::Link> links;
  for (std::size_t i = 0; i < results.size(); ++i)
    links.push_back({fmt::format("result-{}", i + 1),
                     fmt::format("{} ({})", results[i].title(), results[i].dir.generic_string()),
                     results[i].first_answer()});
  // The picture of the first run is at the head of the page, beside the list of results.
  const fs::path picture = dirs[0] / kPicture;
  const bool has_picture = fs::exists(picture);
  if (has_picture) page.begin_lead().add_png(picture, "");
  page.add_contents(links);
  if (has_picture) page.end_lead();
  for (std::size_t i = 0; i < results.size(); ++i) {
    page.begin_part(links[i].id, links[i].title);
    add_result(page, results[i], view, i > 0 || !has_picture);
    page.end_part();
  }
  return written(page, path);
}

void add_missing(const RunReport& report, MissingOutputs& missing) {
  const auto first_line = [](const std::string& text) { return text.substr(0, text.find('\n')); };
  std::map<std::string, std::vector<std::string>> captions;  // by reason, which captions often share
  for (const auto& figure : report.missing_figures)
    captions[first_line(figure.why)].push_back(first_line(figure.caption));
  for (const auto& [why, figures] : captions)
    missing.add(figures.size() == 1 ? fmt::format("figure \"{}\" in {}", figures[0], report.page.string())
                                    : fmt::format("{} figures in {}", figures.size(), report.page.string()),
                why);
}

}  // namespace palpate::report
