#include "fuzz/input.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "palpate/core/error.h"

namespace palpate::fuzz {
namespace {

struct Folder {
  Folder() {
    const std::filesystem::path parent =
        ::access("/dev/shm", W_OK) == 0 ? "/dev/shm" : std::filesystem::temp_directory_path();
    std::string pattern = (parent / "palpate-fuzz-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw std::runtime_error("no folder can be made in " + parent.string());
    path = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  std::filesystem::path path;
};

}  // namespace

std::filesystem::path InputFile::folder() {
  static const Folder folder;
  return folder.path;
}

InputFile::InputFile(const std::string& name, std::string_view bytes) : path_((folder() / name).string()) {
  std::ofstream out(path_, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw std::runtime_error(path_ + " cannot be written");
}

InputFile::~InputFile() { ::unlink(path_.c_str()); }

bool is_read(void (*read)(const void*), const void* context) {
  try {
    read(context);
    return true;
  } catch (const Error& e) {
    promise(std::string_view(e.what()).size() > 10, "a refusal says what is wrong");
    return false;
  }
}

void promise(bool holds, const char* words) {
  if (!holds) throw std::logic_error(std::string("broken promise: ") + words);
}

}  // namespace palpate::fuzz
