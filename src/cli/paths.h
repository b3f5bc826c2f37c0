#pragma once
#include <string>
#include <vector>

namespace palpate::cli {

/// Returns the sorted scene files installed with the program, PREFIX/share/palpate/scenes for
/// PREFIX/bin/palpate.
std::vector<std::string> shipped_scenes();

/// Returns the path of a scene given by its path or by the name of an installed scene ("press-ball").
/// @throws Error with the nearest known name
std::string find_scene(const std::string& name_or_path);

/// Returns the default folder for results of that kind: out/NAME.
std::string default_folder(const std::string& name);

/// Returns the content of a text file.  @throws Error if it cannot be read
std::string read_text(const std::string& path);

/// Returns the first sentence of the comment at the start of a scene file, its description.
std::string first_comment(const std::string& path);

}  // namespace palpate::cli
