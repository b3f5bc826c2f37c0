#pragma once

namespace palpate::model {

/// Calls gmshInitialize without arguments and without the user's settings: in 4.8 its words end with whether
/// these are read, from 4.9 on with whether to run as a program.
inline void start_gmsh(void (*initialize)(int, char**, int, int*), int* error) {
  initialize(0, nullptr, 0, error);
}
inline void start_gmsh(void (*initialize)(int, char**, int, int, int*), int* error) {
  initialize(0, nullptr, 0, 0, error);
}

}  // namespace palpate::model
