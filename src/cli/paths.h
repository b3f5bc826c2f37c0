#pragma once
#include <string>
#include <vector>

namespace palpate::cli {

/// The scene files that come with the program, sorted: PREFIX/share/palpate/scenes beside PREFIX/bin/palpate.
std::vector<std::string> shipped_scenes();

/// A scene by path, or by the name of one that comes with the program ("press-ball").
/// @throws Error with the nearest known name
std::string find_scene(const std::string& name_or_path);

/// Default folder for results of that kind: out/NAME.
std::string default_folder(const std::string& name);

/// The whole of a text file.  @throws Error when it cannot be read
std::string read_text(const std::string& path);

}  // namespace palpate::cli
