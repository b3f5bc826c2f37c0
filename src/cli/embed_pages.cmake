# cmake -DFOLDER=docs -DNAMES=list.txt -DOUT=file.cpp -P embed_pages.cmake: pages as raw string literals.
file(READ ${NAMES} names)
string(CONCAT text
  "// Made by src/cli/embed_pages.cmake from docs/.\n#include \"help_pages.h\"\n\n"
  "namespace palpate::cli {\n\n"
  "const std::vector<HelpPage>& help_pages() {\n"
  "  static const std::vector<HelpPage> pages = {\n")
foreach(name IN LISTS names)
  file(READ ${FOLDER}/${name}.md source)
  string(APPEND text "{\"${name}\", R\"PAGE(${source})PAGE\"},\n")
endforeach()
string(APPEND text "  };\n  return pages;\n}\n\n}  // namespace palpate::cli\n")
file(WRITE ${OUT} "${text}")
