#pragma once
#include <string>

#include "model/make_model.h"

namespace palpate::cli {

/// Arguments of `palpate model`.
struct ModelArguments {
  bool given = false;   ///< False if help was requested and printed
  std::string source;   ///< File, or name of a shape
  std::string output;   ///< Output file; empty: NAME.h5
  std::string picture;  ///< PNG file; empty: no picture
  /// Absolute paths, since the model is built in another working folder
  std::string output_path, picture_path;
  bool quiet = false, verbose = false;
  bool counted = false;   ///< Whether --tetrahedra was given
  bool scaled = false;    ///< Whether --scale was given
  int skin_vertices = 0;  ///< Skin vertices of a shape; 0: its default
  model::Options options;
  std::string as_given;  ///< Options that affect the model, kept in its record
};

}  // namespace palpate::cli
