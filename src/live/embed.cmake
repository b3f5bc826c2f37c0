# cmake -DFOLDER=page/dist -DOUT=file.cpp -P embed.cmake: the files of the page as raw string literals.
set(text "// Made by src/live/embed.cmake from src/live/page/dist.\n#include \"live/page_files.h\"\n\n")
string(APPEND text "namespace palpate::live {\n\n")
foreach(pair page=viewer.html script=viewer.js style=viewer.css)
  string(REPLACE "=" ";" pair ${pair})
  list(GET pair 0 name)
  list(GET pair 1 file)
  file(READ ${FOLDER}/${file} source)
  string(APPEND text
    "std::string_view viewer_${name}() {\n  return R\"LIVEFILE(${source})LIVEFILE\";\n}\n\n")
endforeach()
string(APPEND text "}  // namespace palpate::live\n")
file(WRITE ${OUT} "${text}")
