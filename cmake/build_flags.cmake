# Warnings and sanitizers are PRIVATE usage requirements of palpate_build_flags; there are no global flags.
add_library(palpate_build_flags INTERFACE)
target_compile_options(palpate_build_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  $<$<NOT:$<BOOL:$<TARGET_PROPERTY:PALPATE_SIGNED_INDICES>>>:-Wsign-conversion>
  $<$<BOOL:${PALPATE_WARNINGS_AS_ERRORS}>:-Werror>)
# GCC's garbage collector runs before it requests more memory, over the precompiled header too: up to a fifth
# of the time of compiling a test or a solver. It starts at 1 GiB.
target_compile_options(palpate_build_flags INTERFACE
  "$<$<CXX_COMPILER_ID:GNU>:SHELL:--param ggc-min-heapsize=1048576>")
if(PALPATE_SANITIZE)
  target_compile_options(palpate_build_flags INTERFACE -fsanitize=${PALPATE_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(palpate_build_flags INTERFACE -fsanitize=${PALPATE_SANITIZE})
  target_compile_definitions(palpate_build_flags INTERFACE PALPATE_SANITIZED)
  if(PALPATE_WITH_FUZZERS)  # coverage of all input code; undefined behaviour ends the program
    target_compile_options(palpate_build_flags INTERFACE -fsanitize=fuzzer-no-link,float-cast-overflow
      -fno-sanitize-recover=all -fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/tests/fuzz/third_party.txt)
  elseif(PALPATE_SANITIZE MATCHES "address")
    # These check every reference, which more than doubles the time of compiling. The address sanitizer
    # detects the access itself, where a pointer is null or outside its object.
    target_compile_options(palpate_build_flags INTERFACE -fno-sanitize=null,alignment,object-size,vptr)
  endif()
endif()

# Code whose run time does not matter (command line, reports, tests) is compiled at -O1, a third faster. At
# this level GCC 12 wrongly reports Eigen's empty vectors as uninitialised, and copies of short strings as too
# long.
add_library(palpate_cold_flags INTERFACE)
target_compile_options(palpate_cold_flags INTERFACE $<$<CONFIG:Release>:-O1>
  "$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-array-bounds>")
