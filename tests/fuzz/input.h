#pragma once
#include <filesystem>
#include <string>
#include <string_view>

/// What the targets share: bytes as a file, and how a reader may end.
namespace palpate::fuzz {

/// A file of this process's own, in memory where that is possible: readers take paths, and a fuzzer writes
/// thousands a second.
class InputFile {
 public:
  /// @param name  of the file, by whose ending a reader may choose
  InputFile(const std::string& name, std::string_view bytes);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  const std::string& path() const { return path_; }
  static std::filesystem::path folder();  ///< where they stand; goes with the process

 private:
  std::string path_;
};

/// Runs a reader, and swallows palpate::Error alone.
/// @return whether it was read
/// @throws std::logic_error where an Error says nothing
bool is_read(void (*read)(const void* context), const void* context);
template <class Read>
bool is_read(const Read& read) {
  return is_read([](const void* context) { (*static_cast<const Read*>(context))(); }, &read);
}

/// @throws std::logic_error with these words where `holds` is false: the reader has broken its promise
void promise(bool holds, const char* words);

}  // namespace palpate::fuzz
