#include "report/run_report.h"

#include "palpate/core/error.h"
#include "result.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

RunReport written(const Page& page, const fs::path& path) {
  write(page, path);
  return {path, page.missing_figures()};
}

}  // namespace

RunReport write_run_report(const fs::path& dir) { return write_report({dir}, dir / "report.html"); }

RunReport write_report(const std::vector<fs::path>& dirs, const fs::path& path) {
  PALPATE_CHECK(!dirs.empty(), "a report needs at least one directory");
  std::vector<Result> results;
  for (const fs::path& dir : dirs) results.push_back(open_result(dir));
  if (results.size() == 1) {
    Page page(results[0].title());
    add_result(page, results[0]);
    return written(page, path);
  }
  Page page(fmt::format("palpate: {} results", results.size()));
  std::vector<Page::Link> links;
  for (std::size_t i = 0; i < results.size(); ++i)
    links.push_back({fmt::format("result-{}", i + 1),
                     fmt::format("{} ({})", results[i].title(), results[i].dir.generic_string()),
                     results[i].first_answer()});
  page.add_contents(links);
  for (std::size_t i = 0; i < results.size(); ++i) {
    page.begin_part(links[i].id, links[i].title);
    add_result(page, results[i]);
    page.end_part();
  }
  return written(page, path);
}

}  // namespace palpate::report
