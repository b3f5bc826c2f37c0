#include <fmt/format.h>

#include <filesystem>

#include "cli/missing_outputs.h"
#include "commands.h"
#include "report/run_report.h"
#include "store/result_folder.h"

namespace palpate::cli {

int report(const ReportArguments& arguments) {
  const std::vector<std::filesystem::path> folders(arguments.folders.begin(), arguments.folders.end());
  std::filesystem::path page = arguments.file;
  if (page.empty())
    page = folders.size() == 1 ? folders[0] / "report.html" : std::filesystem::path("report.html");
  if (page.has_parent_path() && !arguments.file.empty())
    store::ResultFolder::make(page.parent_path().string());
  const report::RunReport written = report::write_report(folders, page);
  fmt::print("written: {}\n", written.page.string());
  MissingOutputs missing;
  missing.add(written);
  return missing.close(0);
}

}  // namespace palpate::cli
