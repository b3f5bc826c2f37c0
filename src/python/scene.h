#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::python {

/// A scene's text with changes on top, checked as the program checks it.
class Scene {
 public:
  /// @throws Error as loop::load() and loop::parse()
  static Scene load(const std::string& path);
  static Scene parse(const std::string& text, const std::string& path,
                     const std::vector<std::string>& changes = {});

  /// Changes, each `PATH=VALUE` as --set takes it, checked together.  @throws Error, and then nothing has
  /// changed
  void set(const std::vector<std::string>& more);
  const std::string& text() const { return text_; }  ///< before the changes
  const std::vector<std::string>& changes() const { return changes_; }
  const scene::Description& description() const { return description_; }

 private:
  std::string text_, path_;
  std::vector<std::string> changes_;
  scene::Description description_;
};

}  // namespace palpate::python
