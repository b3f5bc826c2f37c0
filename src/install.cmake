# `cmake --install BUILD --prefix DIR`: the program, the libraries, their headers, and the package that
# find_package(palpate) reads. Nothing installed names the source or build folder: the tree may be moved.
# Two components, which are two Debian packages (packaging/debian.cmake): `program` and `library`.
#
# A part that promises headers (include/palpate/PART) is a component of find_package(palpate).  Parts without
# are installed only where one of these links them.
get_property(parts GLOBAL PROPERTY PALPATE_PARTS)
set(PALPATE_COMPONENTS)
set(open)
foreach(part ${parts})
  string(REGEX REPLACE "^palpate_" "" name ${part})
  if(EXISTS ${PROJECT_SOURCE_DIR}/include/palpate/${name})
    list(APPEND PALPATE_COMPONENTS ${name})
    list(APPEND open ${part})
  endif()
endforeach()
set(exported)
while(open)
  list(POP_FRONT open part)
  if(NOT part IN_LIST exported)
    list(APPEND exported ${part})
    get_target_property(links ${part} LINK_LIBRARIES)
    string(REPLACE "palpate::" "palpate_" links "${links}")
    list(FILTER links INCLUDE REGEX "^palpate_")
    list(APPEND open ${links})
  endif()
endwhile()

install(TARGETS ${exported} EXPORT palpateTargets
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT program NAMELINK_COMPONENT library
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
add_custom_target(installable DEPENDS ${exported})  # all that `cmake --install` wants built
foreach(program palpate palpate-model palpate-touch)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
    add_dependencies(installable ${program})
  endif()
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/palpate DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  COMPONENT library FILES_MATCHING PATTERN "*.h")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/palpate
  COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licence)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/palpate)
install(EXPORT palpateTargets NAMESPACE palpate:: DESTINATION ${package} COMPONENT library)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/palpateConfig.cmake.in
  ${PROJECT_BINARY_DIR}/palpateConfig.cmake
  INSTALL_DESTINATION ${package} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake COMPATIBILITY
  SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/palpateConfig.cmake ${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
  DESTINATION ${package} COMPONENT library)
