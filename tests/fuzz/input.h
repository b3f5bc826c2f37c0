#pragma once
#include <filesystem>
#include <string>
#include <string_view>

/// Shared by the targets: bytes as a file, and the permitted outcomes of a reader.
namespace palpate::fuzz {

/// A file private to this process, in memory where possible: readers take paths, and a fuzzer writes
/// thousands of files per second.
class InputFile {
 public:
  /// @param name  file name, whose extension may select a reader
  InputFile(const std::string& name, std::string_view bytes);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  const std::string& path() const { return path_; }
  static std::filesystem::path folder();  ///< folder of the files; removed when the process ends

 private:
  std::string path_;
};

/// Runs a reader, and catches palpate::Error only.
/// @return whether the input was read
/// @throws std::logic_error if an Error has no message
bool is_read(void (*read)(const void* context), const void* context);
template <class Read>
bool is_read(const Read& read) {
  return is_read([](const void* context) { (*static_cast<const Read*>(context))(); }, &read);
}

/// @throws std::logic_error with these words if `holds` is false: the reader has broken its contract
void promise(bool holds, const char* words);

}  // namespace palpate::fuzz
