# `ninja -C BUILD reference`: the promised headers as HTML, in BUILD/reference/html.
find_program(DOXYGEN_PROGRAM doxygen)
if(DOXYGEN_PROGRAM)
  set(settings ${PROJECT_BINARY_DIR}/reference/Doxyfile)
  file(WRITE ${settings} "@INCLUDE = ${PROJECT_SOURCE_DIR}/packaging/reference/Doxyfile
OUTPUT_DIRECTORY = ${PROJECT_BINARY_DIR}/reference
PROJECT_NUMBER = ${PROJECT_VERSION}
")
  add_custom_target(reference COMMAND ${DOXYGEN_PROGRAM} ${settings}
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} COMMENT "Writing the reference of the library" VERBATIM)
endif()
