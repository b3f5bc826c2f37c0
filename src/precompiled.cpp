// Compiled for its precompiled header alone: see palpate_add_precompiled in the top CMakeLists.txt.
