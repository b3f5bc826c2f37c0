#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::python {

/// Text of a scene with changes applied, checked as the program checks it.
class Scene {
 public:
  /// Reads a scene file.  @throws Error as loop::load()
  static Scene load(const std::string& path);
  /// Makes a scene from TOML text.  @throws Error as loop::parse()
  static Scene parse(const std::string& text, const std::string& path,
                     const std::vector<std::string>& changes = {});

  /// Applies changes, each `PATH=VALUE` as in --set; they are checked together.  @throws Error, and then
  /// leaves the scene unchanged
  void set(const std::vector<std::string>& more);
  const std::string& text() const { return text_; }  ///< Text before changes.
  const std::vector<std::string>& changes() const { return changes_; }
  const scene::Description& description() const { return description_; }
  bool is_from_file() const { return from_file_; }  ///< Whether the text is that of a file.

 private:
  std::string text_, path_;
  std::vector<std::string> changes_;
  bool from_file_ = false;
  scene::Description description_;
};

}  // namespace palpate::python
