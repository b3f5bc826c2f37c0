#pragma once
#include <string_view>
#include <vector>

namespace palpate::gl {

/// Shader source that is compiled into the library.
struct EmbeddedShader {
  std::string_view name;  ///< Path under shaders/.
  std::string_view source;
};

/// Returns all shaders.  Defined in a file that is generated at build time (embed.cmake).
const std::vector<EmbeddedShader>& embedded_shaders();

}  // namespace palpate::gl
