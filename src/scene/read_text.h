#pragma once
#include <string>

namespace palpate::scene {

/// The text of a scene or a study: at most 16 MiB, since it names meshes and does not hold them.
/// @param what  "scene"  @param help  end of the message where there is no such file
/// @throws Error
std::string read_text_file(const std::string& path, const char* what, const char* help);

}  // namespace palpate::scene
