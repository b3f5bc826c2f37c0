#include "session/frame_folder.h"

#include <filesystem>

#include "palpate/core/error.h"

namespace palpate::session {
namespace fs = std::filesystem;
namespace {

/// Removes numbered pictures of an earlier run, which would pass for pictures of this run.
void remove_old(const std::string& folder) {
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() == ".png" && stem.size() >= 4 &&
        stem.find_first_not_of("0123456789") == std::string::npos)
      fs::remove(entry.path(), none);
  }
}

void write_whole(const render::Picture& picture, const fs::path& path) {
  const fs::path draft = path.parent_path() / (path.stem().string() + ".part");
  try {
    render::save_png(picture, draft);
  } catch (const Error&) {
    std::error_code none;
    fs::remove(draft, none);
    throw;
  }
  std::error_code error;
  fs::rename(draft, path, error);
  if (error) fail("{}: cannot be written: {}", path.string(), error.message());
}

class FrameFolder final : public FrameSink {
 public:
  explicit FrameFolder(const std::string& folder) : folder_(folder) {}
  void close() override {}
  std::string missing() const override {
    return fmt::format("frame {} and all later frames", next().string());
  }

 private:
  fs::path next() const { return folder_ / fmt::format("{:04}.png", written()); }

  void put(const render::Picture& picture) override {
    if (written() == 0) {
      std::error_code error;
      fs::create_directories(folder_, error);
      if (error) fail("{}: the folder cannot be made: {}", folder_.string(), error.message());
      remove_old(folder_);
    }
    write_whole(picture, next());
  }

  fs::path folder_;
};

}  // namespace

std::unique_ptr<FrameSink> make_frame_folder(const std::string& folder) {
  return std::make_unique<FrameFolder>(folder);
}

}  // namespace palpate::session
