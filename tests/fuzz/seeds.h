#pragma once
#include <string>

/// The small HDF5 files from which fuzzing starts.
namespace palpate::fuzz {

void write_mesh_seed(const std::string& path);
void write_model_seed(const std::string& path);       ///< one of every kind of object in a model
void write_bare_model_seed(const std::string& path);  ///< a skin only
void write_run_seed(const std::string& path);         ///< two steps
void write_checkpoint_seed(const std::string& path);  ///< one value of each kind

}  // namespace palpate::fuzz
