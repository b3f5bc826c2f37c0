#pragma once

namespace palpate::model {

/// Calls gmshInitialize without arguments and without the user's settings.  The last option is whether to
/// read these in 4.8, and whether to run as a program from 4.9 on.
inline void start_gmsh(void (*initialize)(int, char**, int, int*), int* error) {
  initialize(0, nullptr, 0, error);
}
inline void start_gmsh(void (*initialize)(int, char**, int, int, int*), int* error) {
  initialize(0, nullptr, 0, 0, error);
}

}  // namespace palpate::model
