#pragma once
#include <string>

namespace palpate::scene {

/// Returns the text of a scene or study file.  At most 16 MiB, since meshes are in separate files.
/// @param what  kind of file: "scene"
/// @param help  end of the message where the file does not exist
/// @throws Error where the file does not exist, cannot be read or is too large
std::string read_text_file(const std::string& path, const char* what, const char* help);

}  // namespace palpate::scene
