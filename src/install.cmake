# `cmake --install BUILD --prefix DIR`: the program, the libraries, their headers, and the package that
# find_package(palpate) reads. Nothing installed names the source or build folder: the tree may be moved.
get_property(parts GLOBAL PROPERTY PALPATE_PARTS)
install(TARGETS ${parts} EXPORT palpateTargets
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET palpate)
  install(TARGETS palpate RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(TARGET palpate-model)
  install(TARGETS palpate-model RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/palpate DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h")
foreach(folder scenes shaders)
  if(EXISTS ${PROJECT_SOURCE_DIR}/${folder})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${CMAKE_INSTALL_DATADIR}/palpate)
  endif()
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/palpate)
install(EXPORT palpateTargets NAMESPACE palpate:: DESTINATION ${package})
list(TRANSFORM parts REPLACE "^palpate_" "" OUTPUT_VARIABLE PALPATE_COMPONENTS)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/palpateConfig.cmake.in
  ${PROJECT_BINARY_DIR}/palpateConfig.cmake
  INSTALL_DESTINATION ${package} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake COMPATIBILITY
  SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/palpateConfig.cmake ${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
  DESTINATION ${package})
