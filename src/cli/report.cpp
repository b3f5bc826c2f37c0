#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "cli/missing_outputs.h"
#include "cli/program.h"
#include "commands.h"
#include "report/run_report.h"
#include "scene/view.h"
#include "scene_options.h"
#include "store/folder_lock.h"

namespace palpate::cli {
namespace {

struct ReportArguments {
  std::vector<std::string> folders;  ///< Folders of results
  std::string file;                  ///< Page; empty: report.html, in the folder if there is one only
  std::string view;                  ///< Direction to the eye; empty: that of the run
  double zoom = 0.0;                 ///< Magnification; 0: that of the run
};

int report(const ReportArguments& arguments) {
  const std::vector<std::filesystem::path> folders(arguments.folders.begin(), arguments.folders.end());
  std::filesystem::path page = arguments.file;
  if (page.empty())
    page = folders.size() == 1 ? folders[0] / "report.html" : std::filesystem::path("report.html");
  if (page.has_parent_path() && !arguments.file.empty()) store::FolderLock::make(page.parent_path().string());
  report::FirstView view;
  if (!arguments.view.empty()) view.from = scene::view_direction(arguments.view);
  if (arguments.zoom > 0.0) view.zoom = arguments.zoom;
  const report::RunReport written = report::write_report(folders, page, view);
  fmt::print("written: {}\n", written.page.string());
  MissingOutputs missing;
  report::add_missing(written, missing);
  return missing.close(0);
}

}  // namespace

void add_report(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("report", "make one HTML page of results");
  auto arguments = std::make_shared<ReportArguments>();
  command
      ->add_option("folders", arguments->folders,
                   "output folders of run, compare, study, validate, stability or bench")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("-o,--output", arguments->file,
                   "the page; default report.html, in the folder if only one is given")
      ->type_name("FILE");
  add_view(*command, arguments->view, arguments->zoom);
  command->footer(R"(Examples:
  palpate report out/press-ball
  palpate report out/press-ball --view front --zoom 2
  palpate report out/press-ball out/compare-press-ball out/stability -o out/report.html

The page needs no other file and no network.  It begins with a summary in words; tables sort, charts zoom and
show their values, and the bodies of a run rotate and play (decimated, at most 4 MB).)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return report(*arguments); }; });
}

}  // namespace palpate::cli
