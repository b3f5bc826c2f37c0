#include "cli/paths.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/program.h"
#include "palpate/core/error.h"

namespace palpate::cli {
namespace fs = std::filesystem;
namespace {

fs::path share_folder() { return fs::path(program_path()).parent_path().parent_path() / "share" / "palpate"; }

}  // namespace

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> out;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(share_folder() / "scenes", none))
    if (entry.path().extension() == ".toml") out.push_back(entry.path().string());
  std::sort(out.begin(), out.end());
  return out;
}

std::string find_scene(const std::string& name_or_path) {
  if (fs::is_regular_file(name_or_path)) return name_or_path;
  std::vector<std::string> known;
  for (const std::string& scene : shipped_scenes()) {
    known.push_back(fs::path(scene).stem().string());
    if (known.back() == name_or_path) return scene;
  }
  if (fs::is_directory(name_or_path))
    fail("{}: is a folder; give a scene file (.toml) or the name of a scene: see `palpate list scenes`",
         name_or_path);
  fail("{}: no such file, and no scene that comes with palpate has this name{}", name_or_path,
       suggestion(name_or_path, known));
}

std::string default_folder(const std::string& name) { return (fs::path("out") / name).string(); }

std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf())) fail("{}: cannot be read", path);
  return text.str();
}

std::string first_comment(const std::string& path) {
  std::istringstream lines(read_text(path));
  std::string out;
  for (std::string line; std::getline(lines, line) && line.size() > 1 && line[0] == '#';) {
    const std::size_t begin = line.find_first_not_of("# \t\r");
    if (begin == std::string::npos) break;
    if (!out.empty()) out += ' ';
    out += line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin);
    if (const std::size_t end = out.find(". "); end != std::string::npos) return out.substr(0, end + 1);
    if (out.back() == '.') break;
  }
  return out;
}

}  // namespace palpate::cli
