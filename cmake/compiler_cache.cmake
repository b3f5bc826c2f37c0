# Uses ccache, if installed, with the settings that precompiled headers need. Not among them are
# include_file_mtime and include_file_ctime: with these, an object of a header's old text is stored under the
# new text where the header is edited during compilation (tests/architecture/compiler_cache_test.py).
find_program(PALPATE_CCACHE ccache)
if(PALPATE_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
    CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_DEPEND=1
    CCACHE_NOHASHDIR=1 CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} ${PALPATE_CCACHE})
endif()
