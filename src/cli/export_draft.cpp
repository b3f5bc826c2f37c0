#include "export_draft.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "cli/paths.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"

namespace palpate::cli {
namespace fs = std::filesystem;
namespace {

/// Returns stem and ending of "STEM_NNNN.ENDING"; empty for another name.
std::pair<std::string, std::string> numbered(const fs::path& name) {
  const std::string stem = name.stem().string();
  const std::size_t at = stem.find_last_of('_');
  if (at == std::string::npos || stem.size() - at < 5 ||
      stem.find_first_not_of("0123456789", at + 1) != std::string::npos)
    return {};
  return {stem.substr(0, at), name.extension().string()};
}

/// Returns the uppermost folder of a path that does not exist; empty if all exist.
fs::path first_missing(const fs::path& folder) {
  fs::path missing;
  for (fs::path at = fs::absolute(folder).lexically_normal(); !fs::exists(at) && at.has_relative_path();
       at = at.parent_path())
    missing = at;
  return missing;
}

}  // namespace

ExportDraft::ExportDraft(const std::string& folder)
    : folder_(folder),
      draft_(folder_ / fmt::format(".export-{}.part", getpid())),
      made_(first_missing(folder_)) {
  lock_ = store::FolderLock(folder);
  std::error_code error;
  fs::create_directory(draft_, error);
  if (error)
    fail("{}: this output folder cannot be written ({}); choose another with -o DIR", folder,
         error.message());
}

ExportDraft::~ExportDraft() {
  std::error_code ignored;
  fs::remove_all(draft_, ignored);
  if (!made_.empty()) fs::remove_all(made_, ignored);
}

std::string ExportDraft::path(const std::string& name) {
  names_.push_back(name);
  return (draft_ / name).string();
}

void ExportDraft::write(const std::string& name, const std::string& content) {
  store::write_atomically(path(name), content);
}

void ExportDraft::commit() {
  std::vector<std::pair<std::string, std::string>> kinds;
  for (const std::string& name : names_)
    if (auto kind = numbered(name); !kind.first.empty()) kinds.push_back(std::move(kind));
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_))
    if (std::find(kinds.begin(), kinds.end(), numbered(entry.path().filename())) != kinds.end())
      fs::remove(entry.path(), error);
  for (const std::string& name : names_) {
    fs::rename(draft_ / name, folder_ / name, error);
    if (error) fail("{}: cannot be replaced: {}", (folder_ / name).string(), error.message());
  }
  made_.clear();
}

}  // namespace palpate::cli
