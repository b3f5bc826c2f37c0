#include "loop/result_key.h"

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "core/program.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "store/content_hash.h"
#include "store/provenance.h"

namespace palpate::loop {
namespace {

namespace fs = std::filesystem;

void add_mesh(store::ContentHash& hash, const MeshSpec& mesh, const std::string& folder) {
  if (mesh.file.empty()) return;
  const fs::path path = fs::path(folder) / mesh.file;
  hash.add_file(path.string());
  for (const char* beside : {".node", ".ele"})  // TetGen's pair of files.
    if (path.extension() == ".node" || path.extension() == ".ele")
      hash.add_file(fs::path(path).replace_extension(beside).string());
}

}  // namespace

const std::string& made_by() {
  static const std::string made = [] {
    const store::Provenance p = store::provenance();
    std::string out = p.version + " " + p.commit;
    if (p.commit.find("dirty") == std::string::npos && p.commit != "unknown") return out;
    std::set<std::string> files = {program_path()};
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);)
      if (const auto at = line.find('/');
          at != std::string::npos && line.find("libpalpate_") != std::string::npos)
        files.insert(line.substr(at));
    for (const std::string& file : files) {
      std::error_code none;
      out += fmt::format(" {} {}", fs::file_size(file, none),
                         fs::last_write_time(file, none).time_since_epoch().count());
    }
    return out;
  }();
  return made;
}

std::string without_compare(const std::string& source) {
  if (source.find("\"\"\"") != std::string::npos || source.find("'''") != std::string::npos) return source;
  std::istringstream in(source);
  std::string out;
  bool left_out = false;
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first != std::string::npos && line[first] == '[') {
      const std::size_t name = line.find_first_not_of("[ \t", first);
      left_out = name != std::string::npos &&
                 (line.compare(name, 8, "compare]") == 0 || line.compare(name, 8, "compare.") == 0 ||
                  line.compare(name, 5, "view]") == 0);
    }
    if (!left_out) out += line + "\n";
  }
  return out;
}

std::string result_key(const scene::Description& d, const std::string& more) {
  store::ContentHash hash;
  hash.add(made_by()).add(without_compare(d.source)).add(fmt::format("{}", d.compare.duration_s)).add(more);
  const std::string folder = fs::path(d.path).parent_path().string();
  for (const SoftBodySpec& body : d.bodies) add_mesh(hash, body.mesh, folder);
  for (const scene::Hand& hand : scene::hands_of(d)) {
    add_mesh(hash, hand.tool->mesh, folder);
    if (hand.device && !hand.device->file.empty())
      hash.add_file((fs::path(folder) / hand.device->file).string());
  }
  return hash.hex();
}

}  // namespace palpate::loop
