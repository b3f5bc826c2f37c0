# Sources that are compiled together.  Most of what a source costs to compile is what it includes: eight at
# once take two fifths of the time.  In the preset `dev`, where one source is edited at a time, each is
# compiled alone.  Names in unnamed namespaces are unique in a target therefore.  GCC takes the sources of a
# unit for headers, and warns of classes with members of unnamed namespaces there.
#
# CMake's own units (UNITY_BUILD) name their sources by absolute paths: a compiler cache would serve one
# clone alone.
if(PALPATE_UNITY)
  target_compile_options(palpate_build_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()

# palpate_alone(source...): each is compiled alone, because others have the same names in unnamed namespaces.
function(palpate_alone)
  if(ARGN)
    set_source_files_properties(${ARGN} PROPERTIES PALPATE_ALONE ON)
  endif()
endfunction()

# palpate_make_units(TARGET): makes units of its sources by PALPATE_UNIT_SIZE, a property (default: 8), but
# for those that are alone, are generated or have flags of their own.
function(palpate_make_units target)
  get_target_property(size ${target} PALPATE_UNIT_SIZE)
  if(NOT size)
    set(size 8)
  endif()
  get_target_property(folder ${target} SOURCE_DIR)
  get_target_property(binary ${target} BINARY_DIR)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  set(together "")
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder} NORMALIZE)
    list(APPEND together ${source})
    foreach(property PALPATE_ALONE GENERATED COMPILE_OPTIONS COMPILE_DEFINITIONS INCLUDE_DIRECTORIES)
      get_source_file_property(own ${source} DIRECTORY ${folder} ${property})
      if(own)
        list(REMOVE_ITEM together ${source})
      endif()
    endforeach()
  endforeach()
  list(LENGTH together count)
  if(size EQUAL 1 OR count LESS 2)
    return()
  endif()
  math(EXPR last "${count} - 1")
  foreach(first RANGE 0 ${last} ${size})
    list(SUBLIST together ${first} ${size} unit)
    set_source_files_properties(${unit} DIRECTORY ${folder} PROPERTIES HEADER_FILE_ONLY ON)
    set(text "")
    foreach(source IN LISTS unit)
      file(RELATIVE_PATH path ${binary}/units ${source})
      string(APPEND text "#include \"${path}\"\n")
    endforeach()
    file(CONFIGURE OUTPUT ${binary}/units/${target}_${first}.cpp CONTENT "${text}" @ONLY)
    target_sources(${target} PRIVATE ${binary}/units/${target}_${first}.cpp)
  endforeach()
endfunction()

# palpate_make_all_units(FOLDER): those of every target in it.
function(palpate_make_all_units folder)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type ${target} TYPE)
    if(type MATCHES "(STATIC|SHARED|MODULE|OBJECT)_LIBRARY|EXECUTABLE")
      palpate_make_units(${target})
    endif()
  endforeach()
  get_property(folders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder IN LISTS folders)
    palpate_make_all_units(${subfolder})
  endforeach()
endfunction()
