// Source of the precompiled header: see palpate_add_precompiled in the top CMakeLists.txt.
