#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "store/result_folder.h"

namespace palpate::cli {

/// Files of an export while they are written: in a folder of their own inside the one that they are for.
/// They get their places all together; where that never happens, nothing of them is left.
class ExportDraft {
 public:
  /// Makes the folder with its parents.  @throws Error when it cannot be written
  explicit ExportDraft(const std::string& folder);
  ~ExportDraft();
  ExportDraft(const ExportDraft&) = delete;
  ExportDraft& operator=(const ExportDraft&) = delete;

  /// Where the file of this name is to be written now.
  std::string path(const std::string& name);
  void write(const std::string& name, const std::string& content);
  /// Moves all files to their places.  Files STEM_NNNN.ENDING of an earlier export, for a stem and an ending
  /// of these, are removed first: they would pass for this one's.
  void commit();
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::filesystem::path folder_, draft_;
  std::filesystem::path made_;  ///< the uppermost folder that was not there before; empty: all were
  std::vector<std::string> names_;
  store::ResultFolder lock_;
};

}  // namespace palpate::cli
