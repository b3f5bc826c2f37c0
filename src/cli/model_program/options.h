#pragma once
#include <string>

#include "model/make_model.h"

namespace palpate::cli {

/// What `palpate model` was asked for.
struct ModelArguments {
  bool given = false;   ///< false: help was asked for and given
  std::string source;   ///< a file, or the name of a shape
  std::string output;   ///< empty: NAME.h5
  std::string picture;  ///< PNG file; empty: none
  /// both from the root on, as the model is made in another folder
  std::string output_path, picture_path;
  bool quiet = false, verbose = false;
  bool counted = false;   ///< --tetrahedra was given
  bool scaled = false;    ///< --scale was given
  int skin_vertices = 0;  ///< of a shape; 0: its own number
  model::Options options;
  std::string as_given;  ///< the options that shape the model, for its record
};

/// @throws Error for a line that makes no sense
ModelArguments parse_model(int argc, char** argv);

}  // namespace palpate::cli
