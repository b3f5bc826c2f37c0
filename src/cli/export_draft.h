#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "store/folder_lock.h"

namespace palpate::cli {

/// Files of an export while they are written, in a temporary folder inside the output folder. commit() moves
/// them to their places together; without commit() the destructor removes all of them.
class ExportDraft {
 public:
  /// Creates the folder with its parents.
  /// @throws Error if the folder cannot be written
  explicit ExportDraft(const std::string& folder);
  ~ExportDraft();
  ExportDraft(const ExportDraft&) = delete;
  ExportDraft& operator=(const ExportDraft&) = delete;

  /// Adds a file and returns the path at which to write it.
  std::string path(const std::string& name);
  /// Writes a file with this content.
  void write(const std::string& name, const std::string& content);
  /// Moves all files to their places. Removes files STEM_NNNN.ENDING of an earlier export first, for each
  /// stem and ending among these files: they would pass for files of this export.
  /// @throws Error if a file cannot be replaced
  void commit();
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::filesystem::path folder_, draft_;
  std::filesystem::path made_;  ///< Uppermost folder that the constructor created; empty if all existed
  std::vector<std::string> names_;
  store::FolderLock lock_;
};

}  // namespace palpate::cli
