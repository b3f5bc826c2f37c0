#pragma once
#include <string_view>
#include <vector>

namespace palpate::gl {

struct EmbeddedShader {
  std::string_view name;  ///< path under shaders/
  std::string_view source;
};

/// Defined in a file made at build time (embed.cmake).
const std::vector<EmbeddedShader>& embedded_shaders();

}  // namespace palpate::gl
