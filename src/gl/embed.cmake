# cmake -DFOLDER=shaders -DNAMES=list.txt -DOUT=file.cpp -P embed.cmake: the shaders as raw string literals.
file(READ ${NAMES} names)
string(CONCAT text
  "// Made by src/gl/embed.cmake from shaders/.\n#include \"gl/embedded_shaders.h\"\n\n"
  "namespace palpate::gl {\n\n"
  "const std::vector<EmbeddedShader>& embedded_shaders() {\n"
  "  static const std::vector<EmbeddedShader> shaders = {\n")
foreach(name IN LISTS names)
  file(READ ${FOLDER}/${name} source)
  string(APPEND text "{\"${name}\", R\"GLSL(${source})GLSL\"},\n")
endforeach()
string(APPEND text "  };\n  return shaders;\n}\n\n}  // namespace palpate::gl\n")
file(WRITE ${OUT} "${text}")
