# The Debian packages, by CPack: `./palpate package`, or `cpack` in a build folder where all is built.
#
#   palpate          the programs, the shared libraries that they load, the scenes
#   libpalpate-dev   headers, archives and the package that find_package(palpate) reads
#
# What a program links is found by dpkg-shlibdeps; what it opens by name while it runs is listed here.
find_program(GZIP_PROGRAM gzip REQUIRED)
set(folder ${PROJECT_BINARY_DIR}/packaging)
file(MAKE_DIRECTORY ${folder})

# As Debian's own tools: DEBFULLNAME and DEBEMAIL say who makes the package, else git's user.
set(name $ENV{DEBFULLNAME})
set(email $ENV{DEBEMAIL})
foreach(field name email)
  if(NOT ${field})
    execute_process(COMMAND git config user.${field} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
      OUTPUT_VARIABLE ${field} OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
  endif()
endforeach()
if(NOT name)
  set(name palpate)
endif()
if(NOT email)
  cmake_host_system_information(RESULT host QUERY FQDN)
  set(email root@${host})
endif()
set(PALPATE_MAINTAINER "${name} <${email}>")
set(PALPATE_DEBIAN_VERSION ${PROJECT_VERSION}-1)
execute_process(COMMAND git log -1 --format=%cD WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
  OUTPUT_VARIABLE PALPATE_DATE OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT PALPATE_DATE)  # sources without their history
  string(TIMESTAMP PALPATE_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
endif()

# gzip -n: no time in the file, so that the same sources make the same package.
function(palpate_gzip source target)
  execute_process(COMMAND ${GZIP_PROGRAM} -9nc ${source} OUTPUT_FILE ${target} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
configure_file(${CMAKE_CURRENT_LIST_DIR}/changelog.in ${folder}/changelog @ONLY)
palpate_gzip(${folder}/changelog ${folder}/changelog.Debian.gz)
palpate_gzip(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${folder}/changelog.gz)
include(${CMAKE_CURRENT_LIST_DIR}/copyright.cmake)
palpate_write_copyright(${folder}/copyright)

# Debian's folders, which a plain `cmake --install` leaves out.
set(documents ${folder}/copyright ${folder}/changelog.Debian.gz)
install(FILES ${documents} ${folder}/changelog.gz
  DESTINATION share/doc/palpate COMPONENT program EXCLUDE_FROM_ALL)
install(FILES ${documents} DESTINATION share/doc/libpalpate-dev COMPONENT library EXCLUDE_FROM_ALL)
foreach(page palpate palpate-model palpate-validation)
  if(TARGET ${page})
    configure_file(${CMAKE_CURRENT_LIST_DIR}/${page}.1.in ${folder}/${page}.1 @ONLY)
    palpate_gzip(${folder}/${page}.1 ${folder}/${page}.1.gz)
    install(FILES ${folder}/${page}.1.gz DESTINATION share/man/man1 COMPONENT program EXCLUDE_FROM_ALL)
  endif()
endforeach()
install(FILES ${CMAKE_CURRENT_LIST_DIR}/palpate.lintian-overrides
  DESTINATION share/lintian/overrides RENAME palpate COMPONENT program EXCLUDE_FROM_ALL)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/libpalpate-dev.lintian-overrides
  DESTINATION share/lintian/overrides RENAME libpalpate-dev COMPONENT library EXCLUDE_FROM_ALL)

# What is linked with a shared library depends on its package; ldconfig runs when they come and go.
set(shlibs)
foreach(part core dynamics linear integrate)
  string(APPEND shlibs
    "libpalpate_${part} ${PROJECT_VERSION_MAJOR} palpate (= ${PALPATE_DEBIAN_VERSION})\n")
endforeach()
file(WRITE ${folder}/shlibs "${shlibs}")
file(WRITE ${folder}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA ${folder}/shlibs ${folder}/triggers)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME palpate)
set(CPACK_PACKAGE_VENDOR palpate)
set(CPACK_PACKAGE_CONTACT "${PALPATE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "haptic rendering of deformable objects")
set(CPACK_COMPONENTS_ALL program library)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${PALPATE_MAINTAINER}")
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(about "palpate renders touch: a hand moves a haptic handle, a virtual spring pulls a
rigid tool after it, the tool presses into soft bodies, and the force goes back
to the hand. It needs no device and no display. Every figure has a known error,
and every error has its price in run time.
.
")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "${about}\
This package has the programs palpate, palpate-model, palpate-touch and
palpate-validation, their shared libraries and the scenes that come with them.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME palpate)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# OpenBLAS: named, or apt takes the first package that offers a BLAS, which is several times slower.
set(run_time libopenblas0-pthread)
if(PALPATE_WITH_GL)
  # EGL is opened by name; the drivers bring Mesa's software rasteriser, so that it works without a GPU.
  list(APPEND run_time libegl1 libgl1-mesa-dri)
endif()
list(JOIN run_time ", " CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "fonts-dejavu-core")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "ffmpeg, paraview")
if(PALPATE_WITH_MODEL)  # opened by name, for the mesh formats that it alone reads
  string(APPEND CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS ", ${PALPATE_GMSH_PACKAGE}")
endif()

set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "${about}\
This package has C++ headers and libraries of its parts (soft bodies, contact,
integrators, devices), for programs that find them by CMake:
find_package(palpate COMPONENTS fem integrate).")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libpalpate-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS OFF)
# The shared libraries, and what the headers include or find_package(palpate) looks for.
set(build_time "palpate (= ${PALPATE_DEBIAN_VERSION})" libeigen3-dev libfmt-dev libspdlog-dev
  libccd-dev libhdf5-dev libqhull-dev libsqlite3-dev nlohmann-json3-dev pkg-config)
if(PALPATE_WITH_GL)
  list(APPEND build_time libepoxy-dev)
endif()
if(PALPATE_WITH_TOOL)
  list(APPEND build_time libsimbody-dev)
endif()
list(JOIN build_time ", " CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "cmake (>= 3.25), g++")
include(CPack)
