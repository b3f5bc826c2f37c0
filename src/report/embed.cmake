# cmake -DFOLDER=page/dist -DOUT=file.cpp -P embed.cmake: the page's scripts as raw string literals.
string(CONCAT text
  "// Made by src/report/embed.cmake from src/report/page/dist.\n#include \"report/embedded_scripts.h\"\n\n"
  "namespace palpate::report {\n\n")
foreach(name page three view)
  file(READ ${FOLDER}/${name}.js source)
  string(APPEND text
    "std::string_view ${name}_script() {\n  return R\"PAGEJS(${source})PAGEJS\";\n}\n\n")
endforeach()
string(APPEND text "}  // namespace palpate::report\n")
file(WRITE ${OUT} "${text}")
